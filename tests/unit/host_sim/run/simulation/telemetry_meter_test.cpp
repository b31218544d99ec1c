// What a robot sent, in frames and as a share of its line.
#include "host_sim/run/simulation/run_loop.h"

#include <gtest/gtest.h>

#include <string_view>

namespace screed {
namespace {

RobotOutput sending(std::string_view bytes) {
  RobotOutput output{};
  std::copy(bytes.begin(), bytes.end(), output.radio_out);
  output.radio_out_count = static_cast<uint8_t>(bytes.size());
  return output;
}

TEST(TelemetryMeter, CountsWholeLinesAndAllBytes) {
  TelemetryMeter meter;
  meter.add(0, sending("t1001FF\rt1011"));
  meter.add(0, sending("00\r"));
  meter.add(0, sending(""));
  EXPECT_EQ(meter.frames(), 2U);
  EXPECT_DOUBLE_EQ(meter.line_share(1.0), 16.0 / 5760.0);
  EXPECT_DOUBLE_EQ(meter.line_share(0.01), 16.0 / 57.6);
}

TEST(TelemetryMeter, KeepsTheLastFrameOfEachMessage) {
  TelemetryMeter meter;
  // POWER of robot 1, cut in two: 7200 mV, then 5000 mV.
  meter.add(10'000, sending("t31450000201C"));
  EXPECT_FALSE(meter.latest().value("power.battery").has_value());
  meter.add(20'000, sending("07\r"));
  EXPECT_EQ(meter.latest().value("power.battery"), 7200.0);
  meter.add(30'000, sending("t31450000881307\r"));
  EXPECT_EQ(meter.latest().value("power.battery"), 5000.0);
  EXPECT_EQ(meter.latest().age_s(*find_message("POWER"), 1'030'000), 1.0);
}

TEST(TelemetryMeter, BytesBehindTheValidOnesAreNotSent) {
  RobotOutput output = sending("t1000\rt1000\r");
  output.radio_out_count = 6;
  TelemetryMeter meter;
  meter.add(0, output);
  EXPECT_EQ(meter.frames(), 1U);
}

}  // namespace
}  // namespace screed
