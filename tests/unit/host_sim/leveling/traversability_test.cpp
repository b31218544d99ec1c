// Drives of known shares.
#include "host_sim/leveling/traversability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace screed {
namespace {

constexpr BedBounds kEndless{0.0, 0.0, BedEdge::kWrapped};
constexpr TraversabilityLimits kLimits{0.1, 0.5, 2.0, kEndless};

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

void drive(TraversabilityMeter& meter, const SimFrame& frame, int ticks) {
  for (int i = 0; i < ticks; ++i) meter.on_tick(frame);
}

/// With the middle of the robot there.
SimFrame at(double x, double y) {
  SimFrame frame;
  frame.x = x;
  frame.y = y;
  return frame;
}

/// In ticks of 10 mm.
void drive_east(TraversabilityMeter& meter, double from_x, double y, double length_m) {
  SimFrame frame;
  frame.delta_x = 0.01;
  for (int tick = 1; tick <= std::lround(length_m / 0.01); ++tick) {
    frame.x = from_x + 0.01 * tick;
    frame.y = y;
    meter.on_tick(frame);
  }
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
  TraversabilityMeter without({0.1, 0.5, 0.0, kEndless});
  drive(without, frame, 50);
  EXPECT_EQ(without.shares().off_site, 0.0);
  TraversabilityMeter on_bed({0.1, 0.5, 0.0, {2.0, 1.0, BedEdge::kOpen}});
  for (const SimFrame& place : {at(0.0, 0.0), at(0.99, 0.49), at(-1.01, 0.0), at(0.0, 0.51)})
    drive(on_bed, place, 1);
  EXPECT_EQ(on_bed.shares().off_site, 0.5);
}

// A strip 0.2 m wide: four squares, and the round end of it.
TEST(SiteCoverage, IsTheStripUnderTheRobot) {
  TraversabilityMeter meter({0.1, 0.5, 0.0, {2.0, 1.0, BedEdge::kWalled}});
  drive_east(meter, -1.0, 0.0, 2.0);
  EXPECT_NEAR(meter.shares().visited, 4.0 * 40.0 / (20.0 * 40.0), 0.001);
  drive_east(meter, -1.0, 0.0, 2.0);
  EXPECT_NEAR(meter.shares().visited, 0.2, 0.001) << "the same again";
}

TEST(SiteCoverage, OfACircleRoundTheStartWhereverThatLies) {
  for (const double start_x : {0.0, 2.0}) {
    TraversabilityMeter meter({0.1, 0.5, 0.5, {10.0, 10.0, BedEdge::kOpen}});
    drive_east(meter, start_x, 1.0, 1.0);
    // Half of a strip across: 2 (r^2 asin(w/r) + w sqrt(r^2 - w^2)) / 2, and a cap behind the
    // start.
    const double strip = 0.25 * std::asin(0.2) + 0.1 * std::sqrt(0.24);
    const double cap = 0.5 * std::numbers::pi * 0.01;
    EXPECT_NEAR(meter.shares().visited, (strip + cap) / (std::numbers::pi * 0.25), 0.02) << start_x;
  }
}

TEST(SiteCoverage, WhatLiesBeyondTheBedIsNoSite) {
  TraversabilityMeter meter({2.0, 0.5, 5.0, {2.0, 2.0, BedEdge::kWalled}});
  drive(meter, at(0.0, 0.0), 1);
  EXPECT_EQ(meter.shares().visited, 1.0);
}

TEST(SiteCoverage, AnEndlessSiteHasNoShare) {
  TraversabilityMeter meter({0.1, 0.5, 0.0, kEndless});
  drive(meter, at(0.0, 0.0), 1);
  EXPECT_TRUE(std::isnan(meter.shares().visited));
}

TEST(SiteCoverage, GoesOnOverTheEdgeOfABedThatRepeats) {
  TraversabilityMeter meter({0.1, 0.5, 0.3, {1.0, 1.0, BedEdge::kWrapped}});
  SimFrame frame = at(0.45, 0.0);
  drive(meter, frame, 1);
  const double before = meter.shares().visited;
  frame.x = -0.45;
  frame.delta_x = 0.01;
  drive(meter, frame, 10);  // one in ten is looked at
  EXPECT_GT(meter.shares().visited, before);
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
