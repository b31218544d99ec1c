// Closed loop on soil: a robot that strokes moves ground downhill, and nothing that watches it
// takes the slip for a fault.
// Long: soil moves by millimetres a minute.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

constexpr double kSlope_deg = 12.0;

/// A robot at work on a slope of gravel that rises to the east, between walls.
class StrokesOnGravel : public ::testing::Test {
 protected:
  static WorldOptions options() {
    WorldOptions options;
    options.soil = soil_preset("gravel");
    options.physics_step_s = 0.005;
    return options;
  }
  static Parameters parameters() {
    Parameters parameters;
    parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kStrokes);
    parameters.site_radius() = 1200;
    parameters.site_x() = 750;
    parameters.site_y() = 750;
    parameters.stroke_up() = 240;  // with the default it slides down so steep a slope
    return parameters;
  }
  bool strokes() const { return drive_.robot.leveling().state() == LevelingState::kStroke; }
  Place place() const {
    Place place{};
    drive_.robot.position().get(place);
    return place;
  }
  /// Sum of height times place, east of `from_m`, m^3 m: falls where ground goes to the west. About
  /// the place of work, since what the robot presses down weighs nothing there.
  double moment(double from_m) const {
    const HeightField& ground = drive_.world.terrain();
    double sum = 0.0;
    for (int y = 0; y < ground.ny(); ++y) {
      for (int x = 0; x < ground.nx(); ++x) {
        sum += ground.node(x, y) * kHeightUnit_m * (ground.node_x(x) - from_m);
      }
    }
    return sum * ground.spacing_m() * ground.spacing_m();
  }

  TestDrive drive_{HeightField::ramp(1.5, 0.01, kSlope_deg), options(), parameters()};
};

TEST_F(StrokesOnGravel, MoveGroundDownhillAndAreTakenForNoFault) {
  ASSERT_TRUE(drive_.run_until(30.0, [&] { return strokes(); }));
  const double work_x_m = drive_.position().x();
  const double before = moment(work_x_m);
  const Place at = place();
  int ticks = 0;
  for (; strokes() && ticks < 8 * kTickRate_hz; ++ticks) {
    drive_.tick();
    ASSERT_FALSE(drive_.robot.slip_watch().stuck()) << ticks;
    // A tick or two of travel at its begin.
    ASSERT_NEAR(place().mm[kX], at.mm[kX], 6) << "the tracks' travel is not the robot's";
    ASSERT_NEAR(place().mm[kY], at.mm[kY], 6);
  }
  EXPECT_EQ(ticks, 8 * kTickRate_hz);
  EXPECT_LT(moment(work_x_m) - before, -2e-6) << "2 cm^3 over a metre";
  EXPECT_TRUE(drive_.robot.supervisor().running());
  EXPECT_EQ(drive_.robot.supervisor().faults(), 0);
}

TEST_F(StrokesOnGravel, AStopInTheMiddleOfAStrokeIsNoFault) {
  // The link is lost, each time at another moment of a stroke.
  for (int i = 0; i < 6; ++i) {
    TestDrive drive(HeightField::ramp(1.5, 0.01, kSlope_deg), options(), parameters());
    ASSERT_TRUE(drive.run_until(30.0, [&] {
      return drive.robot.leveling().state() == LevelingState::kStroke;
    })) << i;
    drive.run(1.0 + 0.07 * i);
    drive.tamper = [](SensorSample& sample) { sample.radio_in_count = 0; };
    ASSERT_TRUE(drive.run_until(2.0, [&] {
      return drive.robot.supervisor().state() == RobotState::kStopped;
    })) << i;
    EXPECT_EQ(drive.robot.leveling().state(), LevelingState::kStroke) << "else it was none";
    drive.run(1.0);
    EXPECT_NE(drive.robot.supervisor().state(), RobotState::kFault) << i;
    EXPECT_EQ(drive.robot.supervisor().faults(), 0) << i;
  }
}

}  // namespace
}  // namespace screed::testing
