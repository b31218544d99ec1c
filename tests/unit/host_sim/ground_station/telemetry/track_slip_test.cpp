// Slip of both tracks from telemetry: motions whose slip is known.
#include "host_sim/ground_station/telemetry/track_slip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "firmware/protocol/messages.h"
#include "firmware/protocol/slcan.h"

namespace screed {
namespace {

/// Counts of 0.5 mm, 200 mm from track to track.
constexpr BoardConstants kTestBoard = {8000, 1831, 200, 7200, 250, 145};

/// A robot of constant speeds that says so.
struct Motion {
  double left_m_per_s;  ///< of the track
  double right_m_per_s;
  double turn_rad_per_s = 0.0;
  double share = 1.0;        ///< of the mean travel
  double heading_rad = 0.0;  ///< at the start
  int counts = 0;            ///< of both at the start
};

class Telemetry {
 public:
  /// Its messages up to that time; the slip with the last POSITION.
  std::optional<TrackSlip> say(const Motion& motion, double duration_s, double begin_s = 0.0) {
    std::optional<TrackSlip> last;
    for (int step = 0; step * 0.05 <= duration_s + 1e-9; ++step) {
      const double time_s = step * 0.05;
      const auto time_us = static_cast<std::uint64_t>(std::llround((begin_s + time_s) * 1e6));
      const auto count = [&](double speed) {
        return static_cast<std::uint16_t>(motion.counts + std::lround(speed * time_s / 0.5e-3));
      };
      add(time_us, message::Encoders{count(motion.left_m_per_s), count(motion.right_m_per_s), 0});
      if (step % 2 == 0) {
        const double turns =
            (motion.heading_rad + motion.turn_rad_per_s * time_s) / (2.0 * std::numbers::pi);
        add(time_us, message::Odometry{
                         0, 0, static_cast<std::uint16_t>((turns - std::floor(turns)) * 36000.0)});
      }
      if (step % 10 == 0) {
        last = add(time_us,
                   message::Position{0, 0, 0,
                                     static_cast<std::uint8_t>(std::lround(motion.share * 255.0))});
      }
    }
    return last;
  }

 private:
  template <class Message>
  std::optional<TrackSlip> add(std::uint64_t time_us, const Message& message) {
    const CanFrame frame = frame_of(message);
    std::uint8_t data[8] = {};
    std::copy(frame.data, frame.data + frame.size, data);
    return estimate_.add(time_us, *find_message(frame.id), message_bits(data));
  }

  TrackSlipEstimate estimate_{kTestBoard};
};

std::optional<TrackSlip> slip_of(const Motion& motion, double duration_s = 2.0) {
  Telemetry telemetry;
  return telemetry.say(motion, duration_s);
}

void expect_slip(const Motion& motion, double left, double right) {
  const std::optional<TrackSlip> slip = slip_of(motion);
  ASSERT_TRUE(slip.has_value());
  ASSERT_TRUE(slip->left.has_value());
  ASSERT_TRUE(slip->right.has_value());
  EXPECT_NEAR(*slip->left, left, 0.015);
  EXPECT_NEAR(*slip->right, right, 0.015);
}

TEST(TrackSlip, OfARobotThatRollsIsNone) {
  expect_slip({0.2, 0.2}, 0.0, 0.0);
  expect_slip({-0.2, -0.2}, 0.0, 0.0);
  expect_slip({0.1, 0.3, 1.0}, 0.0, 0.0);    // (0.3 - 0.1) / 0.2 m to the left
  expect_slip({0.2, -0.2, -2.0}, 0.0, 0.0);  // on the spot, to the right
}

TEST(TrackSlip, StraightOnItIsWhatIsMissingFromTheTravel) {
  expect_slip({0.2, 0.2, 0.0, 0.6}, 0.4, 0.4);
  expect_slip({-0.2, -0.2, 0.0, 0.6}, 0.4, 0.4);
  expect_slip({0.2, 0.2, 0.0, 0.0}, 1.0, 1.0);
}

TEST(TrackSlip, OfATurnItTellsTheTracksApart) {
  // The left one spins on the spot, round which the right one drives: 0.3 m/s / 0.2 m. The middle
  // makes 0.15 m/s of 0.2.
  expect_slip({0.1, 0.3, 1.5, 0.75}, 1.0, 0.0);
  // A turn on the spot that turns half as far as the tracks say.
  expect_slip({0.2, -0.2, -1.0}, 0.5, 0.5);
}

// A track that the ground carries farther than it runs brakes: negative, forward and backward, to
// -1; one that is carried against its own way is above 1, to 1.5.
TEST(TrackSlip, OfATrackThatBrakesItIsNegative) {
  // The middle makes 0.2 m/s, the tracks' middles 0.2 -+ 0.025.
  expect_slip({0.15, 0.25, 0.25}, 1.0 - 0.175 / 0.15, 1.0 - 0.225 / 0.25);
  expect_slip({-0.15, -0.25, -0.25}, 1.0 - 0.175 / 0.15, 1.0 - 0.225 / 0.25);
  // 0.3 m/s over the ground with a track of 0.1.
  expect_slip({0.1, 0.5, 0.0}, -1.0, 1.0 - 0.3 / 0.5);
  // 0.1 m/s straight on with the left track backward.
  expect_slip({-0.1, 0.3, 0.0}, 1.5, 1.0 - 0.1 / 0.3);
  // The middle of the left one makes -0.04 m/s, that runs at 0.1.
  expect_slip({0.1, 0.3, 2.4}, 1.4, 1.0 - 0.44 / 0.3);
}

TEST(TrackSlip, CountsAndHeadingWrap) {
  expect_slip({0.3, 0.3, 0.0, 1.0, 0.0, 65'000}, 0.0, 0.0);
  expect_slip({0.1, 0.3, 1.0, 1.0, 5.3}, 0.0, 0.0);
  expect_slip({0.3, 0.1, -1.0, 1.0, 0.9}, 0.0, 0.0);
}

TEST(TrackSlip, OfATrackThatHardlyRunsThereIsNone) {
  const std::optional<TrackSlip> slip = slip_of({0.01, 0.2, 0.95});
  ASSERT_TRUE(slip.has_value());
  EXPECT_FALSE(slip->left.has_value());
  EXPECT_TRUE(slip->right.has_value());
}

TEST(TrackSlip, NeedsHalfASecondOfHistory) {
  EXPECT_FALSE(slip_of({0.2, 0.2}, 0.45).has_value());
  EXPECT_TRUE(slip_of({0.2, 0.2}, 0.5).has_value());
}

TEST(TrackSlip, BeginsAnewAfterAGap) {
  Telemetry telemetry;
  ASSERT_TRUE(telemetry.say({0.2, 0.2}, 2.0).has_value());
  // The robot restarted: counts from zero again.
  EXPECT_FALSE(telemetry.say({0.2, 0.2}, 0.4, 10.0).has_value());
  const std::optional<TrackSlip> slip = telemetry.say({0.2, 0.2, 0.0, 0.5}, 2.0, 20.0);
  ASSERT_TRUE(slip.has_value());
  EXPECT_NEAR(slip->left.value_or(9.0), 0.5, 0.015);
}

}  // namespace
}  // namespace screed
