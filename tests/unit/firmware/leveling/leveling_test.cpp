// The leveling algorithms: Algorithm 6, its successor with a spin on the peak, and the fence over
// both.
#include "firmware/leveling/leveling.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <optional>

namespace screed {
namespace {

constexpr Angle degrees(double value) {
  return static_cast<Angle>(value * 65536.0 / 360.0);
}

Parameters parameters_of(LevelingAlgorithm algorithm) {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(algorithm);
  return parameters;
}

/// A robot on a slope, seen by the algorithm alone.
class Walker {
 public:
  explicit Walker(const Parameters& parameters) : leveling(parameters) { leveling.start(); }

  LevelingState tick(double pitch_deg) {
    LevelingInput input{};
    input.pitch = degrees(pitch_deg);
    input.roll = degrees(roll_deg);
    input.heading = degrees(heading_deg);
    input.place.mm[kX] = x_mm;
    input.drive = drive;
    input.stuck = stuck;
    input.backwards = motion.speed_mm_per_s < 0;
    motion = leveling.tick(input);
    return leveling.state();
  }
  /// Number of ticks, this one included, for which the state stays the same at this pitch.
  int ticks_in(LevelingState state, double pitch_deg) {
    int ticks = 0;
    while (tick(pitch_deg) == state && ticks < 10000) ++ticks;
    return ticks;
  }

  Leveling leveling;
  MotionCommand motion = {0, 0};
  MotionCommand drive = {0, 0};
  int16_t x_mm = 0;
  double heading_deg = 0.0;
  double roll_deg = 0.0;
  bool stuck = false;
};

TEST(HillSensing, ClimbsAboveTheThresholdAndWalksBelow) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kHillSensing);
  parameters.climb_threshold() = 500;
  parameters.climb_hysteresis() = 100;
  Walker walker(parameters);
  EXPECT_EQ(walker.leveling.state(), LevelingState::kIdle);
  EXPECT_EQ(walker.tick(0.0), LevelingState::kWalk);
  EXPECT_EQ(walker.tick(4.9), LevelingState::kWalk);
  EXPECT_EQ(walker.tick(5.1), LevelingState::kClimb);
  EXPECT_EQ(walker.motion.speed_mm_per_s, parameters.climb_speed());
  EXPECT_EQ(walker.motion.yaw_rate, 0);
  EXPECT_EQ(walker.tick(4.1), LevelingState::kClimb);  // within the hysteresis
  EXPECT_EQ(walker.leveling.peaks(), 0);
  EXPECT_EQ(walker.tick(3.9), LevelingState::kWalk);
  EXPECT_EQ(walker.leveling.peaks(), 1);
  EXPECT_EQ(walker.tick(4.5), LevelingState::kWalk);
  EXPECT_EQ(walker.tick(-80.0), LevelingState::kWalk);  // down a hill is no hill
}

TEST(HillSensing, AClimbEndsOneLegAndTheWalkBeginsAnother) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kHillSensing);
  parameters.walk_leg_min() = 20000;
  parameters.walk_leg_max() = 20000;
  Walker walker(parameters);
  walker.tick(0.0);
  const MotionCommand leg = walker.motion;
  walker.tick(0.0);
  EXPECT_EQ(walker.motion.yaw_rate, leg.yaw_rate);
  walker.tick(20.0);
  walker.tick(0.0);
  EXPECT_NE(walker.motion.yaw_rate, leg.yaw_rate);
}

TEST(SpinOnPeak, SpinsOnceTheDeclineBegins) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kSpinOnPeak);
  parameters.spin_time() = 2000;
  Walker walker(parameters);
  EXPECT_EQ(walker.tick(2.0), LevelingState::kWalk);
  EXPECT_EQ(walker.tick(8.0), LevelingState::kClimb);
  EXPECT_EQ(walker.tick(1.0),
            LevelingState::kClimb);  // no incline any more, no decline yet: straight on
  EXPECT_EQ(walker.tick(-0.9), LevelingState::kClimb);
  EXPECT_EQ(walker.motion.yaw_rate, 0);
  EXPECT_EQ(walker.tick(-1.1), LevelingState::kSpin);
  EXPECT_EQ(walker.leveling.peaks(), 1);
  EXPECT_EQ(walker.motion.speed_mm_per_s, 0);
  EXPECT_NEAR(std::abs(walker.motion.yaw_rate), 90.0 * 65536.0 / 360.0, 1);
  // Two seconds in all, whatever the pitch says meanwhile.
  EXPECT_EQ(walker.ticks_in(LevelingState::kSpin, 30.0), 199);
  EXPECT_EQ(walker.leveling.state(), LevelingState::kWalk);
}

TEST(SpinOnPeak, SpinsLeftAndRightInTurn) {
  Walker walker(parameters_of(LevelingAlgorithm::kSpinOnPeak));
  std::optional<bool> last_left;
  for (int peak = 0; peak < 6; ++peak) {
    walker.tick(10.0);
    ASSERT_EQ(walker.tick(10.0), LevelingState::kClimb);
    ASSERT_EQ(walker.tick(-5.0), LevelingState::kSpin);
    const bool left = walker.motion.yaw_rate > 0;
    EXPECT_NE(left, last_left.value_or(!left));
    last_left = left;
    walker.ticks_in(LevelingState::kSpin, 0.0);
  }
  EXPECT_EQ(walker.leveling.peaks(), 6);
}

TEST(SpinOnPeak, APlateauEndsTheClimbAfterThreeSeconds) {
  Walker walker(parameters_of(LevelingAlgorithm::kSpinOnPeak));
  for (int tick = 0; tick < 1000; ++tick) ASSERT_NE(walker.tick(10.0), LevelingState::kSpin);
  EXPECT_EQ(walker.leveling.state(), LevelingState::kClimb);  // a long hill is no plateau
  EXPECT_EQ(walker.ticks_in(LevelingState::kClimb, 1.0), 299);
  EXPECT_EQ(walker.leveling.state(), LevelingState::kWalk);
  // A new incline on the way starts the time again.
  walker.tick(10.0);
  for (int tick = 0; tick < 250; ++tick) walker.tick(0.0);
  walker.tick(6.0);
  EXPECT_EQ(walker.ticks_in(LevelingState::kClimb, 0.0), 299);
}

/// The commanded turn rate on a slope, degrees/s.
double turn_on_slope(const Parameters& parameters, double pitch_deg, double roll_deg) {
  Leveling leveling(parameters);
  leveling.start();
  LevelingInput input{};
  input.pitch = degrees(pitch_deg);
  input.roll = degrees(roll_deg);
  const MotionCommand motion = leveling.tick(input);
  EXPECT_EQ(leveling.state(), LevelingState::kClimb);
  EXPECT_EQ(motion.speed_mm_per_s, parameters.climb_speed());
  return motion.yaw_rate * 360.0 / 65536.0;
}

TEST(Climb, TurnsTowardsTheSteepestAscent) {
  for (const LevelingAlgorithm algorithm :
       {LevelingAlgorithm::kHillSensing, LevelingAlgorithm::kSpinOnPeak}) {
    Parameters parameters = parameters_of(algorithm);
    parameters.climb_turn() = 1;
    EXPECT_NEAR(turn_on_slope(parameters, 10.0, 0.0), 0.0, 0.1);
    // Left side up: the ascent is to the left, by the slope's direction and not by its size.
    EXPECT_NEAR(turn_on_slope(parameters, 10.0, 10.0), 45.0, 0.1);
    EXPECT_NEAR(turn_on_slope(parameters, 20.0, 20.0), 45.0, 0.1);
    EXPECT_NEAR(turn_on_slope(parameters, 10.0, -5.0), -26.565, 0.1);
    parameters.climb_turn() = 4;
    EXPECT_NEAR(turn_on_slope(parameters, 20.0, 2.0), 4.0 * 5.711, 0.1);
    EXPECT_NEAR(turn_on_slope(parameters, 10.0, 30.0), 60.0, 0.1);  // no faster
    EXPECT_NEAR(turn_on_slope(parameters, 10.0, -30.0), -60.0, 0.1);
    parameters.climb_turn() = 0;  // Algorithm 6 as printed
    EXPECT_EQ(turn_on_slope(parameters, 10.0, 10.0), 0.0);
  }
}

TEST(Climb, GoesStraightOnOverAPlateau) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kSpinOnPeak);
  parameters.climb_turn() = 1;
  Leveling leveling(parameters);
  leveling.start();
  LevelingInput input{};
  input.pitch = degrees(10.0);
  leveling.tick(input);
  input.pitch = degrees(1.0);
  input.roll = degrees(5.0);
  EXPECT_EQ(leveling.tick(input).yaw_rate, 0);
  EXPECT_EQ(leveling.state(), LevelingState::kClimb);
}

TEST(RandomWalk, WalksOverHillsAsWell) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kRandomWalk);
  Walker walker(parameters);
  for (const double pitch_deg : {0.0, 20.0, -20.0}) {
    EXPECT_EQ(walker.tick(pitch_deg), LevelingState::kWalk);
    EXPECT_GE(walker.motion.speed_mm_per_s, parameters.walk_speed_min());
    EXPECT_LE(walker.motion.speed_mm_per_s, parameters.walk_speed_max());
  }
  EXPECT_EQ(walker.leveling.peaks(), 0);
}

/// At the fence in the east, facing east, in the tick in which it is told to back in.
Walker at_the_fence(Parameters parameters) {
  parameters.site_radius() = 1000;
  Walker walker(parameters);
  walker.tick(0.0);
  EXPECT_GT(walker.motion.speed_mm_per_s, 0);
  walker.x_mm = 1001;
  EXPECT_EQ(walker.tick(20.0), LevelingState::kReturn) << "not even a hill keeps it out there";
  EXPECT_EQ(walker.motion.speed_mm_per_s, -parameters.walk_speed_max());
  return walker;
}

// Backwards, since a turn digs in: it does not face the fence again and again.
TEST(Leveling, AtTheFenceItTurnsRoundAndWalksAcrossTheSite) {
  for (const LevelingAlgorithm algorithm :
       {LevelingAlgorithm::kRandomWalk, LevelingAlgorithm::kHillSensing,
        LevelingAlgorithm::kSpinOnPeak}) {
    const Parameters parameters = parameters_of(algorithm);
    Walker walker = at_the_fence(parameters);
    for (const int16_t x_mm : std::initializer_list<int16_t>{1010, 1001, 990, 0, -1000}) {
      walker.x_mm = x_mm;
      ASSERT_EQ(walker.tick(0.0), LevelingState::kWalk) << x_mm;
      EXPECT_LE(walker.motion.speed_mm_per_s, -parameters.walk_speed_min());
      EXPECT_GE(walker.motion.speed_mm_per_s, -parameters.walk_speed_max());
    }
    // At the other side it drives on forwards.
    walker.x_mm = -1001;
    ASSERT_EQ(walker.tick(0.0), LevelingState::kReturn);
    EXPECT_EQ(walker.motion.speed_mm_per_s, parameters.walk_speed_max());
    ASSERT_EQ(walker.tick(0.0), LevelingState::kWalk);
    EXPECT_GE(walker.motion.speed_mm_per_s, parameters.walk_speed_min());
  }
}

TEST(Leveling, OutsideItWalksInwardsAlone) {
  Walker walker = at_the_fence(parameters_of(LevelingAlgorithm::kRandomWalk));
  ASSERT_EQ(walker.tick(0.0), LevelingState::kWalk);
  walker.heading_deg = 44.0;
  EXPECT_EQ(walker.tick(0.0), LevelingState::kWalk);
  walker.heading_deg = 46.0;
  EXPECT_EQ(walker.tick(0.0), LevelingState::kReturn);
  EXPECT_EQ(walker.motion.speed_mm_per_s, 0) << "turns on the spot";
  EXPECT_LT(walker.motion.yaw_rate, 0);
  walker.heading_deg = 180.0;
  EXPECT_EQ(walker.tick(0.0), LevelingState::kWalk);
  EXPECT_GT(walker.motion.speed_mm_per_s, 0) << "forwards by now";
}

// Where its tail leads, a hill is where the tail rises.
TEST(Leveling, ARobotThatWalksBackwardsClimbsBackwards) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kSpinOnPeak);
  parameters.climb_turn() = 1;
  Walker walker = at_the_fence(parameters);
  walker.x_mm = 0;
  EXPECT_EQ(walker.tick(20.0), LevelingState::kWalk);
  walker.roll_deg = 10.0;
  EXPECT_EQ(walker.tick(-10.0), LevelingState::kClimb);
  EXPECT_EQ(walker.motion.speed_mm_per_s, -parameters.climb_speed());
  // The ascent lies behind on the left: clockwise the tail turns there.
  EXPECT_NEAR(walker.motion.yaw_rate * 360.0 / 65536.0, -45.0, 0.1);
  EXPECT_EQ(walker.tick(2.0), LevelingState::kSpin);
  EXPECT_EQ(walker.leveling.peaks(), 1);
}

TEST(Leveling, ARunBeginsForwards) {
  Walker walker = at_the_fence(parameters_of(LevelingAlgorithm::kRandomWalk));
  walker.x_mm = 0;
  walker.leveling.start();
  walker.tick(0.0);
  EXPECT_GT(walker.motion.speed_mm_per_s, 0);
}

// It would leave the site, were it to back off as far as inside.
TEST(Leveling, StuckOutsideTheSiteItBacksOffHalfAsFar) {
  const auto ticks_backed_off = [](int16_t x_mm) {
    Walker walker = at_the_fence(parameters_of(LevelingAlgorithm::kRandomWalk));
    walker.x_mm = x_mm;
    EXPECT_EQ(walker.tick(0.0), LevelingState::kWalk);
    walker.stuck = true;
    int ticks = 0;
    while (walker.tick(0.0) == LevelingState::kEscape && walker.motion.speed_mm_per_s > 0) {
      walker.stuck = false;
      ++ticks;
    }
    return ticks;
  };
  EXPECT_EQ(ticks_backed_off(900), 148);
  EXPECT_EQ(ticks_backed_off(1001), 72);
}

// Strokes carry a robot against a wall whichever way it drove before: there, back may be the wall.
TEST(Leveling, StuckByAWallItEscapesTowardsTheMiddle) {
  const auto speed_of_escape = [](int16_t x_mm, int16_t y_mm, double heading_deg, bool backwards,
                                  int16_t walls_mm) {
    Parameters parameters = parameters_of(LevelingAlgorithm::kRandomWalk);
    parameters.site_x() = walls_mm;
    parameters.site_y() = walls_mm;
    Leveling leveling(parameters);
    leveling.start();
    LevelingInput input{};
    input.place.mm[kX] = x_mm;
    input.place.mm[kY] = y_mm;
    input.heading = degrees(heading_deg);
    input.backwards = backwards;
    input.stuck = true;
    const MotionCommand motion = leveling.tick(input);
    EXPECT_EQ(leveling.state(), LevelingState::kEscape);
    return motion.speed_mm_per_s;
  };
  for (const bool backwards : {false, true}) {
    EXPECT_GT(speed_of_escape(0, 620, -90.0, backwards, 750), 0) << "its tail at the wall";
    EXPECT_LT(speed_of_escape(0, 620, 90.0, backwards, 750), 0);
    EXPECT_GT(speed_of_escape(630, 620, -90.0, backwards, 750), 0) << "in a corner";
    EXPECT_LT(speed_of_escape(-600, -100, 170.0, backwards, 750), 0);
    // Not beside a wall, or without walls, it goes back where it came from.
    const int sign = backwards ? 1 : -1;
    EXPECT_GT(sign * speed_of_escape(0, 500, -90.0, backwards, 750), 0);
    EXPECT_GT(sign * speed_of_escape(0, 620, -90.0, backwards, 0), 0);
  }
}

TEST(Leveling, AClimbCutShortByTheFenceIsNoPeak) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kHillSensing);
  parameters.site_radius() = 1000;
  Walker walker(parameters);
  ASSERT_EQ(walker.tick(20.0), LevelingState::kClimb);
  walker.x_mm = 1001;
  ASSERT_EQ(walker.tick(20.0), LevelingState::kReturn);
  EXPECT_EQ(walker.leveling.peaks(), 0);
}

TEST(Leveling, ASpinIsFinishedBeforeTheFenceCounts) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kSpinOnPeak);
  parameters.site_radius() = 1000;
  Walker walker(parameters);
  walker.tick(10.0);
  ASSERT_EQ(walker.tick(-5.0), LevelingState::kSpin);
  walker.x_mm = 1010;
  EXPECT_EQ(walker.tick(0.0), LevelingState::kSpin);
  walker.ticks_in(LevelingState::kSpin, 0.0);
  EXPECT_EQ(walker.tick(0.0), LevelingState::kReturn);
}

TEST(Leveling, DriveFollowsTheGroundStationAnywhere) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kDrive);
  parameters.site_radius() = 100;
  Walker walker(parameters);
  walker.x_mm = 5000;
  walker.drive = {-70, 1234};
  EXPECT_EQ(walker.tick(20.0), LevelingState::kDrive);
  EXPECT_EQ(walker.motion.speed_mm_per_s, -70);
  EXPECT_EQ(walker.motion.yaw_rate, 1234);
}

TEST(Leveling, StartBeginsAnew) {
  Walker walker(parameters_of(LevelingAlgorithm::kSpinOnPeak));
  walker.tick(10.0);
  ASSERT_EQ(walker.tick(-5.0), LevelingState::kSpin);
  walker.leveling.start();
  EXPECT_EQ(walker.leveling.state(), LevelingState::kIdle);
  EXPECT_EQ(walker.tick(0.0), LevelingState::kWalk);
}

/// The state after one more tick at exactly this pitch.
LevelingState state_at(Leveling& leveling, int32_t pitch) {
  leveling.tick({static_cast<Angle>(pitch), 0, {{0, 0}, {0, 0}}, {0, 0}});
  return leveling.state();
}

TEST(HillSensing, TheThresholdItselfIsNoIncline) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kHillSensing);
  parameters.climb_threshold() = 500;
  parameters.climb_hysteresis() = 100;
  const Angle rising = angle_from_centidegrees(500);
  const int32_t falling = rising - angle_from_centidegrees(100);
  Leveling leveling(parameters);
  leveling.start();
  EXPECT_EQ(state_at(leveling, rising), LevelingState::kWalk);
  EXPECT_EQ(state_at(leveling, rising + 1), LevelingState::kClimb);
  EXPECT_EQ(state_at(leveling, falling + 1), LevelingState::kClimb);
  EXPECT_EQ(state_at(leveling, falling), LevelingState::kWalk);
}

TEST(SpinOnPeak, ThresholdsThemselvesAreNeitherInclineNorDecline) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kSpinOnPeak);
  parameters.climb_threshold() = 500;
  parameters.climb_hysteresis() = 100;
  const Angle rising = angle_from_centidegrees(500);
  const Angle hysteresis = angle_from_centidegrees(100);
  Leveling leveling(parameters);
  leveling.start();
  EXPECT_EQ(state_at(leveling, rising), LevelingState::kWalk);
  EXPECT_EQ(state_at(leveling, rising + 1), LevelingState::kClimb);
  EXPECT_EQ(state_at(leveling, -hysteresis), LevelingState::kClimb);
  EXPECT_EQ(state_at(leveling, -hysteresis - 1), LevelingState::kSpin);
  // Just below the incline it is a plateau, just above it goes on climbing.
  for (const int above : {0, 1}) {
    Leveling climber(parameters);
    climber.start();
    state_at(climber, rising + 1);
    for (int tick = 0; tick < 400; ++tick) state_at(climber, rising - hysteresis + above);
    EXPECT_EQ(climber.state(), above == 1 ? LevelingState::kClimb : LevelingState::kWalk);
  }
}

TEST(SpinOnPeak, TheFirstSpinIsToTheRight) {
  Walker walker(parameters_of(LevelingAlgorithm::kSpinOnPeak));
  walker.tick(20.0);
  ASSERT_EQ(walker.tick(-20.0), LevelingState::kSpin);
  EXPECT_LT(walker.motion.yaw_rate, 0);
  EXPECT_EQ(walker.motion.speed_mm_per_s, 0);
}

TEST(Leveling, ATrainingDriveIsDrivenToItsEnd) {
  Parameters parameters = parameters_of(LevelingAlgorithm::kTrainingDrive);
  parameters.training_block() = 20;
  Leveling leveling(parameters);
  leveling.start();
  int ticks = 0;
  bool moved = false;
  for (; leveling.state() != LevelingState::kDone && ticks < 1000; ++ticks) {
    const MotionCommand motion = leveling.tick({0, 0, {{0, 0}, {0, 0}}, {0, 0}});
    moved = moved || motion.speed_mm_per_s != 0;
    const bool over = ticks >= 150;
    ASSERT_TRUE(over || leveling.state() == LevelingState::kTrainingDrive) << ticks;
  }
  EXPECT_TRUE(moved);
  EXPECT_NEAR(ticks, 8 * 20, 1);
  EXPECT_EQ(leveling.tick({0, 0, {{0, 0}, {0, 0}}, {0, 0}}).speed_mm_per_s, 0);
}

// A value that the parameter cannot have; the supervisor refuses it as well.
TEST(Leveling, AnAlgorithmThatThereIsNotStandsAndDoesNothingElse) {
  Parameters parameters;
  parameters.algorithm() = 99;
  parameters.site_radius() = 1000;
  Leveling leveling(parameters);
  leveling.start();
  LevelingInput input{};
  input.stuck = true;
  input.drive = {100, 500};
  input.place.mm[kX] = 2000;
  for (int tick = 0; tick < 10; ++tick) {
    const MotionCommand motion = leveling.tick(input);
    EXPECT_EQ(motion.speed_mm_per_s, 0);
    EXPECT_EQ(motion.yaw_rate, 0);
    EXPECT_EQ(leveling.state(), LevelingState::kIdle);
  }
}

}  // namespace
}  // namespace screed
