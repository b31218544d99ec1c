// The downlink of a running robot: rates, load, and that nothing is lost on a radio that loses
// nothing.
#include <gtest/gtest.h>

#include <map>

#include "firmware/protocol/e2e.h"
#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

TEST(Downlink, AllMessagesAtTheirRatesWithinHalfOfTheLineAndNoneLost) {
  constexpr double kSeconds = 30.0;
  TestDrive drive(HeightField::flat(20.0, 0.1), drive_options(0.1, 5.0));
  ASSERT_TRUE(drive.start());
  std::map<uint16_t, int> sent;
  uint64_t bytes = 0;
  uint64_t frames = 0;
  SlcanParser parser;
  drive.run(1.0);
  const uint64_t heard_before = drive.world.ground_station().frames();
  for (int tick = 0; tick < kSeconds * kTickRate_hz; ++tick) {
    drive.tick();
    bytes += drive.output.radio_out_count;
    CanFrame frame{};
    for (uint8_t i = 0; i < drive.output.radio_out_count; ++i) {
      if (!parser.feed(drive.output.radio_out[i], frame)) continue;
      ASSERT_TRUE(e2e_check(frame.id, frame.data, frame.size));
      ++sent[frame.id];
      ++frames;
    }
  }
  const uint64_t heard = drive.world.ground_station().frames() - heard_before;
  EXPECT_EQ(drive.world.ground_station().rejected_frames(), 0U);
  EXPECT_NEAR(static_cast<double>(heard), static_cast<double>(frames), 8.0);  // on their way
  EXPECT_LE(static_cast<double>(bytes), 0.5 * 5760.0 * kSeconds);
  const std::map<uint16_t, double> rates = {
      {kIdHeartbeat, 5}, {kIdAttitude, 25}, {kIdEncoders, 20}, {kIdMotors, 20},
      {kIdLeveling, 10}, {kIdOdometry, 10}, {kIdAccelRaw, 10}, {kIdGyroRaw, 10},
      {kIdMagRaw, 2},    {kIdPower, 2},     {kIdBaro, 1},      {kIdHealth, 2},
      {kIdLink, 1},      {kIdTime, 1},      {kIdPosition, 2},  {kIdCommandAck, 4}};
  for (const auto& [id, rate] : rates) {
    EXPECT_NEAR(sent[id] / kSeconds, rate, 0.04 + 1.0 / kSeconds) << std::hex << id;
  }
  EXPECT_EQ(sent.size(), rates.size());
}

}  // namespace
}  // namespace screed::testing
