// Steps, masses and dampers that explicit forces would not carry; and what a world does with a
// robot that is where nothing can have brought it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/physics/world/plant.h"
#include "host_sim/standin/standin_plant.h"
#include "paths.h"
#include "tests/ros_robot.h"
#include "tests/step_one.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

Assembly rover() {
  return import_urdf(std::string(kBoardsFolder) + "/a_star_32u4/rover5.urdf");
}

Eigen::Vector3d position(const Environment& world) {
  return world.robot(0).vehicle().chassis().pose.translation();
}

void drive(Environment& world, double seconds, double duty) {
  const auto steps = std::lround(seconds * 100.0 * world.steps_per_tick());
  for (int64_t i = 0; i < steps; ++i) testing::step_one(world, {duty, duty});
}

/// What the run ends with; "" when it goes on.
std::string end_of(Environment& world, double seconds) {
  try {
    drive(world, seconds, 0.5);
  } catch (const RunError& error) {
    return error.what();
  }
  return "";
}

TEST(Divergence, ALongStepOnRigidGroundDrivesAsAShortOneDoes) {
  for (const bool tracks : {true, false}) {
    PlantOptions options;
    options.vehicle.tracks = tracks;
    options.physics_step_s = 0.001;
    Plant with_short_steps(HeightField::flat(4.0, 0.05), rover(), options);
    drive(with_short_steps, 2.0, 0.5);
    for (const double step_s : {0.002, 0.0025, 0.005, 0.01}) {
      options.physics_step_s = step_s;
      Plant plant(HeightField::flat(4.0, 0.05), rover(), options);
      drive(plant, 2.0, 0.5);
      EXPECT_GT(position(plant).x(), 0.2);
      EXPECT_TRUE(position(plant).isApprox(position(with_short_steps), 0.005))
          << (tracks ? "tracks, " : "wheels, ") << step_s << " s: " << position(plant).transpose();
    }
  }
}

/// A robot with a rod on a hinge behind it, whose end falls on the ground.
Assembly with_rod(double rod_kg) {
  char rod[400];
  std::snprintf(
      rod, sizeof rod,
      "<link name=\"rod\"><inertial><origin xyz=\"-0.1 0 0\"/><mass value=\"%g\"/>"
      "<inertia ixx=\"%g\" ixy=\"0\" ixz=\"0\" iyy=\"%g\" iyz=\"0\" izz=\"%g\"/></inertial>"
      "<collision><origin xyz=\"-0.1 0 0\"/><geometry><box size=\"0.02 0.01 0.01\"/>"
      "</geometry></collision></link>\n",
      rod_kg, 1e-5 * rod_kg, 1e-5 * rod_kg, 1e-5 * rod_kg);
  testing::RosRobot ros;
  ros.extra = rod + testing::joint_text("hinge", "continuous", "base_link", "rod",
                                        "<origin xyz=\"-0.11 0 0\"/><axis xyz=\"0 1 0\"/>");
  const TempFolder folder;
  write_text(folder.path() / "rod.urdf", testing::urdf_of(ros));
  return import_urdf(folder.path() / "rod.urdf");
}

TEST(Divergence, ALightLinkOnRigidGroundLeavesTheRobotWhereItIs) {
  PlantOptions options;
  options.vehicle.tracks = false;
  for (const double rod_kg : {0.1, 0.01, 0.001, 1e-5}) {
    Plant plant(HeightField::flat(4.0, 0.05), with_rod(rod_kg), options);
    const double height = position(plant).z();
    drive(plant, 1.0, 0.0);
    EXPECT_NEAR(position(plant).z(), height, 0.001) << rod_kg << " kg";
    EXPECT_LT(plant.robot(0).vehicle().chassis().velocity.norm(), 0.01) << rod_kg << " kg";
  }
}

TEST(Divergence, MotionThatNothingHasGivenEndsTheRun) {
  PlantOptions options;
  options.soil = soil_preset("gravel");
  options.soil->cohesion_pa = 1e6;  // over a shear modulus of 1.7 mm: too stiff for 5 ms
  options.physics_step_s = 0.005;
  const HeightField ground = HeightField::from_function(
      101, 101, 0.02, false, [](double x, double) { return 0.02 * std::sin(9.0 * x); });
  std::string end;
  try {
    Plant plant(ground, rover(), options);
    end = end_of(plant, 5.0);
  } catch (const RunError& error) {
    end = error.what();
  }
  EXPECT_EQ(end.rfind("the physics diverged at ", 0), 0U) << end;
  EXPECT_NE(end.find(" J of motion that nothing has given; "), std::string::npos) << end;
}

TEST(Divergence, AFallIsNotTakenForOne) {
  PlantOptions options;
  options.starts[0].z_m = 2.0;
  Plant plant(HeightField::flat(4.0, 0.05), rover(), options);
  EXPECT_EQ(end_of(plant, 3.0), "");
  EXPECT_LT(position(plant).z(), 0.1);
}

TEST(Divergence, AStandInThatLosesTheGroundEndsTheRun) {
  PlantOptions options;
  options.soil = soil_preset("soft");
  const HeightField cliff =
      HeightField::from_function(201, 201, 0.02, false, [](double x, double) { return 1.7 * x; });
  StandInPlant plant(cliff, rover(), options);
  const std::string end = end_of(plant, 60.0);
  EXPECT_EQ(end.rfind("the surrogate world diverged: the robot's origin ", 0), 0U) << end;
}

}  // namespace
}  // namespace screed
