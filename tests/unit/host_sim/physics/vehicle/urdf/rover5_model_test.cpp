// The robot model of the Rover 5 against its published figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/unit/host_sim/physics/vehicle/urdf/urdf_fixture.h"

namespace screed::urdf {
namespace {

const std::string kRover = "boards/a_star_32u4/rover5.urdf";

// About z.
Eigen::Matrix3d cylinder_tensor(double mass, double radius, double length) {
  const double across = mass * (3.0 * radius * radius + length * length) / 12.0;
  return Eigen::Vector3d(across, across, mass * radius * radius / 2.0).asDiagonal();
}

constexpr double kLegLength = 0.058;
constexpr double kHighest_rad = 0.714410816;  // asin(0.038 / 0.058)

Assembly rover_at(double leg_angle_rad) {
  UrdfOptions options;
  options.leg_angle_rad = leg_angle_rad;
  return import_urdf(kRover, options);
}

// Height of the origin of Body over the wheel axles.
double height(const Assembly& rover) {
  return -body(rover, "fl_Wheel").pose.translation().z();
}

TEST(Rover5, HasThePublishedDimensions) {
  const Assembly rover = import_urdf(kRover);
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
  for (const char* name : {"fl_Wheel", "fr_Wheel", "bl_Wheel", "br_Wheel"}) {
    const AssemblyBody& wheel = body(rover, name);
    const auto& shape = std::get<Cylinder>(wheel.collision.at(0).geometry);
    EXPECT_EQ(shape.radius, 0.030);
    const Eigen::Isometry3d pose = wheel.pose * wheel.collision.at(0).pose;
    EXPECT_NEAR(std::abs((pose.linear() * Eigen::Vector3d::UnitZ()).y()), 1.0, 1e-9) << name;
    const Eigen::Vector3d half(shape.radius, shape.length / 2.0, shape.radius);
    low = low.cwiseMin(pose.translation() - half);
    high = high.cwiseMax(pose.translation() + half);
  }
  EXPECT_NEAR(high.x() - low.x(), 0.245, 1e-6);
  EXPECT_NEAR(high.y() - low.y(), 0.225, 1e-6);
  EXPECT_NEAR(body(rover, "fl_Wheel").pose.translation().y() -
                  body(rover, "fr_Wheel").pose.translation().y(),
              0.195, 1e-9);
}

TEST(Rover5, IsDrivenAtTheFront) {
  const Assembly rover = import_urdf(kRover);
  for (const std::string corner : {"fl", "fr", "bl", "br"}) {
    const AssemblyJoint& wheel = joint(rover, corner + "_Wheel_joint");
    EXPECT_EQ(wheel.kind,
              corner[0] == 'f' ? AssemblyJoint::Kind::Motor : AssemblyJoint::Kind::Revolute);
    EXPECT_TRUE(wheel.axis.isApprox(Eigen::Vector3d::UnitY(), 1e-9));
    EXPECT_EQ(joint(rover, corner + "_Leg_joint").kind, AssemblyJoint::Kind::Fixed);
  }
}

TEST(Rover5, WeighsOnePointTwoKilogramsBalancedOverTheTracks) {
  const Assembly rover = import_urdf(kRover);
  std::vector<int> all;
  for (std::size_t i = 0; i < rover.bodies.size(); ++i) all.push_back(static_cast<int>(i));
  const Inertia whole = composed_inertia(rover, all);
  EXPECT_NEAR(whole.mass, 1.2, 1e-9);
  EXPECT_NEAR(whole.pose.translation().x(), 0.0, 1e-9);
  EXPECT_NEAR(whole.pose.translation().y(), 0.0, 1e-9);
  const std::vector<int> chassis = rigid_group(rover, rover.body_index("Body"));
  EXPECT_EQ(chassis.size(), 7U);  // Body, four legs, Board, Imu
  EXPECT_NEAR(composed_inertia(rover, chassis).mass, 0.88, 1e-9);
}

TEST(Rover5, InertiaIsThatOfTheShapes) {
  const Assembly rover = import_urdf(kRover);
  for (const AssemblyBody& part : rover.bodies) {
    if (part.inertia.mass == 0.0) continue;
    const Shape& shape = part.collision.at(0);
    const Eigen::Matrix3d& turn = shape.pose.linear();
    Eigen::Matrix3d expected;
    if (const auto* box = std::get_if<Box>(&shape.geometry)) {
      expected = box_tensor(part.inertia.mass, box->size);
    } else {
      const auto& cylinder = std::get<Cylinder>(shape.geometry);
      expected = cylinder_tensor(part.inertia.mass, cylinder.radius, cylinder.length);
    }
    EXPECT_TRUE(part.inertia.tensor.isApprox(turn * expected * turn.transpose(), 1e-8))
        << part.name;
    EXPECT_TRUE(part.inertia.pose.translation().isApprox(shape.pose.translation())) << part.name;
  }
}

TEST(Rover5, LegAngleSetsHeightAndWheelbaseAndKeepsBodyLevel) {
  const double leg_joint_x = 0.0925 - kLegLength * std::cos(20.0 * kPi / 180.0);
  for (const double angle_rad : {0.0, 0.1, 20.0 * kPi / 180.0, 0.5, kHighest_rad}) {
    const Assembly rover = rover_at(angle_rad);
    const double x = leg_joint_x + kLegLength * std::cos(angle_rad);
    const double z = -0.0115 - kLegLength * std::sin(angle_rad);
    EXPECT_TRUE(
        body(rover, "fl_Wheel").pose.translation().isApprox(Eigen::Vector3d(x, 0.0975, z), 1e-7));
    EXPECT_TRUE(
        body(rover, "fr_Wheel").pose.translation().isApprox(Eigen::Vector3d(x, -0.0975, z), 1e-7));
    EXPECT_TRUE(
        body(rover, "bl_Wheel").pose.translation().isApprox(Eigen::Vector3d(-x, 0.0975, z), 1e-7));
    EXPECT_TRUE(
        body(rover, "br_Wheel").pose.translation().isApprox(Eigen::Vector3d(-x, -0.0975, z), 1e-7));
  }
}

TEST(Rover5, LegsCover38MillimetresOfHeight) {
  EXPECT_NEAR(height(rover_at(kHighest_rad)) - height(rover_at(0.0)), 0.038, 1e-8);
  EXPECT_NEAR(height(import_urdf(kRover)), height(rover_at(20.0 * kPi / 180.0)), 1e-8);
}

TEST(Rover5, LegAngleOutOfRangeIsRefused) {
  UrdfOptions options;
  options.leg_angle_rad = 0.72;
  EXPECT_NE(error_of_file(kRover, options)
                .find("joint 'fl_Leg_joint': a leg angle of 0.72 rad is out of range; allowed: "),
            std::string::npos)
      << error_of_file(kRover, options);
  EXPECT_NE(error_of_file(kRover, options).find(" to 0.714411"), std::string::npos);
  options.leg_angle_rad = -0.01;
  EXPECT_NE(error_of_file(kRover, options).find("out of range"), std::string::npos);
  options.leg_angle_rad = std::numeric_limits<double>::infinity();
  EXPECT_EQ(error_of_file(kRover, options), kRover + ": the leg angle is not finite");
  options.leg_angle_rad = 0.3;
  options.joint_angles_rad["br_Leg_joint"] = 0.1;
  EXPECT_NE(
      error_of_file(kRover, options).find("is set both by the leg angle and by its own angle"),
      std::string::npos);
}

TEST(Rover5, OneLegCanBeSetByItself) {
  UrdfOptions options;
  options.joint_angles_rad["br_Leg_joint"] = 0.2;  // from 20 degrees further down
  const Assembly rover = import_urdf(kRover, options);
  EXPECT_NEAR(body(rover, "br_Wheel").pose.translation().z(),
              -0.0115 - kLegLength * std::sin(20.0 * kPi / 180.0 + 0.2), 1e-8);
  EXPECT_NEAR(body(rover, "bl_Wheel").pose.translation().z(),
              -0.0115 - kLegLength * std::sin(20.0 * kPi / 180.0), 1e-8);
}

}  // namespace
}  // namespace screed::urdf
