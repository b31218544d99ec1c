// Drives of known shares.
#include "host_sim/leveling/traversability.h"

#include <gtest/gtest.h>

namespace screed {
namespace {

constexpr TraversabilityLimits kLimits{0.1, 0.5, 2.0};

/// Both tracks at this speed, the chassis forwards at that.
SimFrame driving(double tracks, double chassis) {
  SimFrame frame;
  frame.track_left = tracks;
  frame.track_right = tracks;
  frame.velocity_x = chassis;
  frame.slip_left = tracks == 0.0 ? 0.0 : (tracks - chassis) / tracks;
  frame.slip_right = frame.slip_left;
  return frame;
}

void drive(TraversabilityMeter& meter, const SimFrame& frame, int ticks, bool on_bed = true) {
  for (int i = 0; i < ticks; ++i) meter.on_tick(frame, on_bed);
}

TEST(Traversability, NothingYetIsNoShare) {
  const Traversability shares = TraversabilityMeter(kLimits).shares();
  EXPECT_EQ(shares.stuck, 0.0);
  EXPECT_EQ(shares.slip, 0.0);
}

TEST(Traversability, TracksThatRunInPlaceAreStuckFromTheFirstSecondOn) {
  TraversabilityMeter meter(kLimits);
  drive(meter, driving(0.1, 0.0), 400);
  // 99 ticks have no second behind them.
  EXPECT_DOUBLE_EQ(meter.shares().stuck, 301.0 / 400.0);
  EXPECT_DOUBLE_EQ(meter.shares().slip, 1.0);
}

TEST(Traversability, AFifthOfTheTracksTravelIsTravel) {
  for (const auto& [chassis, stuck] : {std::pair{0.021, false}, {0.019, true}, {-0.021, false}}) {
    TraversabilityMeter meter(kLimits);
    drive(meter, driving(0.1, chassis), 100);
    EXPECT_EQ(meter.shares().stuck > 0.0, stuck) << chassis;
  }
}

TEST(Traversability, ARobotThatStandsOrTurnsIsNotStuck) {
  TraversabilityMeter meter(kLimits);
  drive(meter, driving(0.0, 0.0), 300);
  drive(meter, driving(0.02, 0.0), 300);  // slower than tracks that run
  SimFrame turning;
  turning.track_left = -0.1;
  turning.track_right = 0.1;
  turning.rate_z = 1.0;  // 0.1 m/s at the tracks
  drive(meter, turning, 300);
  EXPECT_EQ(meter.shares().stuck, 0.0);
  turning.rate_z = 0.1;
  drive(meter, turning, 300);
  EXPECT_GT(meter.shares().stuck, 0.1);
}

/// To and fro, and left and right, each for less than the second that is looked at.
TEST(Traversability, ARobotThatReversesIsStuckOnlyWhereItDoesNotFollowItsTracks) {
  const auto reversing = [](double share) {
    TraversabilityMeter meter(kLimits);
    SimFrame left;
    left.track_left = -0.1;
    left.track_right = 0.1;
    left.rate_z = share;  // 0.1 m/s at the tracks where it follows
    SimFrame right;
    right.track_left = 0.1;
    right.track_right = -0.1;
    right.rate_z = -share;
    for (int i = 0; i < 5; ++i) {
      drive(meter, driving(0.1, share * 0.1), 50);
      drive(meter, driving(-0.1, -share * 0.1), 50);
      drive(meter, left, 50);
      drive(meter, right, 50);
    }
    return meter.shares().stuck;
  };
  EXPECT_EQ(reversing(1.0), 0.0);
  EXPECT_EQ(reversing(0.3), 0.0);
  EXPECT_GT(reversing(0.1), 0.9);
}

/// Shaking is no travel.
TEST(Traversability, ARobotThatShakesWhileItsTracksDigIsStuck) {
  TraversabilityMeter meter(kLimits);
  for (int i = 0; i < 100; ++i) drive(meter, driving(0.1, i % 2 == 0 ? 0.1 : -0.1), 2);
  EXPECT_GT(meter.shares().stuck, 0.5);
}

TEST(Traversability, CountsTimeTiltedInAnyDirection) {
  TraversabilityMeter meter(kLimits);
  SimFrame frame;
  drive(meter, frame, 50);
  frame.pitch = 0.4;
  frame.roll = 0.4;  // together 0.559
  drive(meter, frame, 30);
  frame.roll = 0.2;  // together 0.446
  drive(meter, frame, 20);
  EXPECT_DOUBLE_EQ(meter.shares().tilted, 0.3);
}

TEST(Traversability, CountsTimeOutsideTheCircleAndOffTheBed) {
  TraversabilityMeter meter(kLimits);
  SimFrame frame = driving(0.1, 0.1);
  frame.delta_x = 0.03;
  frame.delta_y = 0.04;
  drive(meter, frame, 50);  // 2.5 m: the last ten beyond 2 m
  EXPECT_NEAR(meter.shares().off_site, 10.0 / 50.0, 0.021);
  TraversabilityMeter without({0.1, 0.5, 0.0});
  drive(without, frame, 50);
  EXPECT_EQ(without.shares().off_site, 0.0);
  drive(without, frame, 50, false);
  EXPECT_EQ(without.shares().off_site, 0.5);
}

TEST(Traversability, SlipIsThatOfRunningTracks) {
  TraversabilityMeter meter(kLimits);
  drive(meter, driving(0.1, 0.05), 100);
  SimFrame standing;
  standing.slip_left = 0.9;
  drive(meter, standing, 100);
  drive(meter, driving(-0.1, -0.1), 100);
  EXPECT_DOUBLE_EQ(meter.shares().slip, 0.25);
}

}  // namespace
}  // namespace screed
