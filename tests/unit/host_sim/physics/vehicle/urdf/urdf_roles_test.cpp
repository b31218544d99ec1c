// Chassis, wheels and IMU of models with names of their own, in the styles of published models.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>

#include "tests/ros_robot.h"
#include "tests/unit/host_sim/physics/vehicle/urdf/urdf_fixture.h"

namespace screed::urdf {
namespace {

using testing::joint_text;
using testing::RosRobot;
using testing::solid;
using testing::urdf_of;

Assembly read(const RosRobot& robot, const UrdfOptions& options = {}) {
  return import_urdf(write(urdf_of(robot)), options);
}

std::string error_with(const RosRobot& robot, const UrdfOptions& options = {}) {
  return error_of_file(write(urdf_of(robot)), options);
}

std::string name_of(const Assembly& robot, int body) {
  return body < 0 ? "none" : robot.bodies[static_cast<std::size_t>(body)].name;
}

/// Front left, front right, rear left, rear right.
std::string wheel_names(const Assembly& robot) {
  std::string names;
  for (const std::size_t end : {0U, 1U}) {
    for (const std::size_t side : {0U, 1U}) {
      names += names.empty() ? "" : " ";
      names += name_of(robot, robot.wheels[side][end].body);
    }
  }
  return names;
}

const std::string kFour =
    "front_left_wheel_link front_right_wheel_link rear_left_wheel_link rear_right_wheel_link";

void expect_part(const std::string& error, const std::string& part) {
  EXPECT_NE(error.find(part), std::string::npos) << part << "\nin: " << error;
}

// ---- wheels ------------------------------------------------------------------------------

TEST(UrdfRoles, ThesisNames) {
  const Assembly robot = import_urdf(kSmall);
  EXPECT_EQ(name_of(robot, robot.chassis), "Body");
  EXPECT_EQ(wheel_names(robot), "fl_Wheel fr_Wheel bl_Wheel br_Wheel");
  EXPECT_EQ(robot.imu, -1);
  EXPECT_EQ(robot.wheels[1][1].radius_m, 0.1);
  EXPECT_EQ(robot.wheels[1][1].width_m, 0.05);
  EXPECT_TRUE(robot.wheels[1][1].centre.isApprox(Eigen::Vector3d(-0.2, -0.15, 0.0), 1e-12));
}

TEST(UrdfRoles, WheelsAreFoundByNameAndPlaceInAnyOrder) {
  RosRobot ros;
  EXPECT_EQ(wheel_names(read(ros)), kFour);
  std::reverse(ros.wheels.begin(), ros.wheels.end());
  EXPECT_EQ(wheel_names(read(ros)), kFour);
  std::swap(ros.wheels[0], ros.wheels[2]);
  EXPECT_EQ(wheel_names(read(ros)), kFour);
}

TEST(UrdfRoles, TheNameOfTheJointIsEnoughAndCaseDoesNotMatter) {
  RosRobot ros;
  ros.wheels = {{{"a", "FL_WHEEL", "0.1 0.1 0"},
                 {"b", "FR_WHEEL", "0.1 -0.1 0"},
                 {"Wheel3", "x", "-0.1 0.1 0"},
                 {"wheel4", "y", "-0.1 -0.1 0"}}};
  // Nor do other joints that turn, and wheels that stand still.
  ros.extra = "<link name=\"lidar\">" + solid("0.1", "1e-4");
  ros.extra += "</link><link name=\"spare_wheel\"/>" +
               joint_text("lidar_joint", "continuous", "base_link", "lidar") +
               joint_text("spare", "fixed", "base_link", "spare_wheel");
  EXPECT_EQ(wheel_names(read(ros)), "a b Wheel3 wheel4");
}

TEST(UrdfRoles, TheMappingNamesAnyLinks) {
  RosRobot ros;
  ros.chassis = "hull";
  ros.wheels = {{{"lf", "j1", "0.1 0.1 0"},
                 {"rf", "j2", "0.1 -0.1 0"},
                 {"lr", "j3", "-0.1 0.1 0"},
                 {"rr", "j4", "-0.1 -0.1 0"}}};
  ros.extra = "<link name=\"sensor\"/>" + joint_text("sensor_joint", "fixed", "hull", "sensor",
                                                     "<origin xyz=\"0.01 0.02 0.03\"/>");
  UrdfOptions options;
  options.chassis_link = "hull";
  options.wheel_links = {"lf", "rf", "lr", "rr"};
  options.imu_link = "sensor";
  const Assembly robot = read(ros, options);
  EXPECT_EQ(name_of(robot, robot.chassis), "hull");
  EXPECT_EQ(wheel_names(robot), "lf rf lr rr");
  EXPECT_EQ(name_of(robot, robot.imu), "sensor");

  expect_part(error_with(ros),
              "no link of a continuous joint has \"wheel\" in its name or its "
              "joint's ('lf' (joint 'j1'), 'rf' (joint 'j2'), 'lr' (joint 'j3'), "
              "'rr' (joint 'j4'))");
  options.wheel_links[2] = "gone";
  expect_part(error_with(ros, options),
              "there is no link named 'gone' ([vehicle] wheel_links); "
              "the links are hull, lf, rf, lr, rr, sensor");
  options.wheel_links = {"rf", "lf", "lr", "rr"};
  expect_part(error_with(ros, options), "'rf' (joint 'j2') is not to the left (y) of 'lf'");
  options.wheel_links = {"lr", "rr", "lf", "rf"};
  expect_part(error_with(ros, options), "'lr' (joint 'j3') is not in front (x) of 'lf'");
}

TEST(UrdfRoles, WhatIsNotFourWheelsIsNamed) {
  RosRobot two;
  two.wheels[2].link = two.wheels[2].joint = "rear_left";
  two.wheels[3].link = two.wheels[3].joint = "rear_right";
  const std::string error = error_with(two);
  expect_part(error,
              "a robot needs four wheels; by their names (\"wheel\" in that of a continuous "
              "joint or its link) there are 2: 'front_left_wheel_link' (joint "
              "'front_left_wheel'), 'front_right_wheel_link' (joint 'front_right_wheel'); "
              "[vehicle] wheel_links = FRONT_LEFT FRONT_RIGHT REAR_LEFT REAR_RIGHT");
  EXPECT_EQ(error.find('\n'), std::string::npos);

  RosRobot six;
  six.extra = "<link name=\"mid_wheel\">" + solid("0.1", "1e-4");
  six.extra += "</link>" + joint_text("mid", "continuous", "base_link", "mid_wheel");
  expect_part(error_with(six), "there are 5: ");
}

TEST(UrdfRoles, PlacesThatDecideNothingAreNamed) {
  RosRobot aside;
  aside.wheels[3].place = "-0.09 0.01 0";
  expect_part(error_with(aside), "two wheels must be to the left (y > 0) and two to the right");
  RosRobot level;
  level.wheels[2].place = "0.09 0.12 0";
  expect_part(error_with(level), "of two wheels of a side one must be in front (x)");
}

// ---- chassis and IMU ---------------------------------------------------------------------

TEST(UrdfRoles, AChassisAboveAFootprint) {
  RosRobot ros;
  ros.has_footprint = true;
  const Assembly named = read(ros);
  EXPECT_EQ(name_of(named, named.chassis), "base_link");
  // Its frame is that of everything, though it is not the root's.
  EXPECT_TRUE(named.wheels[0][0].centre.isApprox(Eigen::Vector3d(0.09, 0.0975, 0.0), 1e-12));
  ros.chassis = "chassis";  // a name of its own: the first with mass that is fixed to the root
  const Assembly other = read(ros);
  EXPECT_EQ(name_of(other, other.chassis), "chassis");
  ros.has_footprint = false;
  const Assembly root = read(ros);
  EXPECT_EQ(name_of(root, root.chassis), "chassis");
}

TEST(UrdfRoles, AMasslessBaseLinkIsTheChassisWithWhatIsFixedToIt) {
  RosRobot ros;
  ros.chassis = "chassis_link";
  std::string text = urdf_of(ros);
  const std::string base =
      "<link name=\"base_link\"/>" +
      joint_text("base", "fixed", "base_link", "chassis_link", "<origin xyz=\"0 0 0.05\"/>");
  text.insert(text.find("<link"), base);
  const Assembly robot = import_urdf(write(text));
  EXPECT_EQ(name_of(robot, robot.chassis), "base_link");
  EXPECT_NEAR(robot.wheels[0][0].centre.z(), 0.05, 1e-12);
  EXPECT_DOUBLE_EQ(composed_inertia(robot, rigid_group(robot, robot.chassis)).mass, 1.0);
}

TEST(UrdfRoles, TheImuIsAtItsLinkWhichIsFixedToTheChassis) {
  RosRobot ros;
  const std::string link = "<link name=\"imu_link\">" + solid("0.01", "1e-6") + "</link>";
  const std::string at = "<origin xyz=\"0.02 0 0.04\"/><axis xyz=\"0 0 1\"/>";
  ros.extra = link + joint_text("imu_joint", "fixed", "base_link", "imu_link", at);
  EXPECT_EQ(name_of(read(ros), read(ros).imu), "imu_link");
  ros.extra = link + joint_text("imu_joint", "continuous", "base_link", "imu_link", at);
  expect_part(error_with(ros),
              "link 'imu_link': the IMU must be fixed to the chassis, link 'base_link'");
}

// ---- motors ------------------------------------------------------------------------------

int motors(const Assembly& robot) {
  return static_cast<int>(std::count_if(
      robot.joints.begin(), robot.joints.end(),
      [](const AssemblyJoint& joint) { return joint.kind == AssemblyJoint::Kind::Motor; }));
}

TEST(UrdfRoles, OrdinaryWheelJointsAreMotors) {
  RosRobot ros;
  EXPECT_EQ(motors(read(ros)), 4);
  ros.limit = "<limit effort=\"10\" velocity=\"20\"/>";
  EXPECT_EQ(motors(read(ros)), 4);
  // The thesis' rule holds where it is used: the others turn by themselves.
  std::string text = urdf_of(ros);
  text.replace(text.find("velocity=\"20\""), 13, "velocity=\"1.0\"");
  EXPECT_EQ(motors(import_urdf(write(text))), 1);
  ros.wheel_joint = "revolute";
  UrdfOptions options;
  options.wheel_links = {ros.wheels[0].link, ros.wheels[1].link, ros.wheels[2].link,
                         ros.wheels[3].link};
  EXPECT_EQ(motors(read(ros, options)), 0);
}

// ---- axles -------------------------------------------------------------------------------

TEST(UrdfRoles, TheAxleIsThatOfTheJointWhateverTheLinkCallsY) {
  RosRobot ros;  // cylinders along z of a link that is turned to the side
  ros.joint_rpy = "-1.57 0 0";
  ros.axis = "0 0 1";
  ros.wheel_shapes =
      "<collision><origin xyz=\"0 0 0.004\"/><geometry><cylinder radius=\"0.05\" length=\"0.02\"/>"
      "</geometry></collision>";
  const AssemblyWheel wheel = read(ros).wheels[0][0];
  EXPECT_EQ(wheel.radius_m, 0.05);
  EXPECT_EQ(wheel.width_m, 0.02);
  EXPECT_TRUE(wheel.centre.isApprox(Eigen::Vector3d(0.09, 0.1015, 0.0), 1e-4))
      << wheel.centre.transpose();
  ros.axis = "0 0 -1";
  EXPECT_TRUE(read(ros).wheels[0][0].centre.isApprox(wheel.centre, 1e-12));
}

TEST(UrdfRoles, AnAxleThatIsNotAcrossIsRefused) {
  RosRobot ros;
  ros.axis = "0 0 1";
  expect_part(error_with(ros),
              "joint 'front_left_wheel': the axle of wheel "
              "'front_left_wheel_link' is not along y of the chassis, but along "
              "0 0 1");
  ros.axis = "0 1 0.2";
  expect_part(error_with(ros), "is not along y");
  ros.axis = "0 -1 0.05";
  EXPECT_EQ(error_with(ros), "no error");
}

// ---- shapes ------------------------------------------------------------------------------

TEST(UrdfRoles, MeshWheelsAreMeasured) {
  const std::filesystem::path folder = std::filesystem::path(written_file()).parent_path();
  std::filesystem::create_directories(folder / "meshes");
  write_text(folder / "meshes" / "wheel.stl", testing::drum_stl(60.0, 40.0));
  RosRobot ros;
  ros.wheel_shapes =
      "<collision><origin rpy=\"1.5707963267948966 0 0\"/><geometry><mesh "
      "filename=\"package://any_robot/meshes/wheel.stl\" scale=\"0.001 0.001 0.001\"/></geometry>"
      "</collision>";
  const Assembly robot = read(ros);
  EXPECT_NEAR(robot.wheels[1][0].radius_m, 0.06, 1e-6);
  EXPECT_NEAR(robot.wheels[1][0].width_m, 0.04, 1e-6);
  EXPECT_STREQ(robot.wheels[1][0].source, "collision mesh");

  // As in a package: the model in a folder beside that of the meshes.
  std::filesystem::create_directories(folder / "urdf");
  write_text(folder / "urdf" / "robot.urdf", urdf_of(ros));
  EXPECT_NEAR(import_urdf(folder / "urdf" / "robot.urdf").wheels[0][0].radius_m, 0.06, 1e-6);
}

// ---- xacro -------------------------------------------------------------------------------

TEST(UrdfRoles, XacroIsNamed) {
  RosRobot ros;
  ros.axis = "0 ${side} 0";
  expect_part(error_with(ros),
              "<axis> is xacro, which has to be expanded to URDF first: xacro "
              "robot.urdf > expanded.urdf");
  ros = {};
  ros.extra = "<xacro:wheel name=\"a\"/>";
  expect_part(error_with(ros), "<xacro:wheel> is xacro");
  ros.extra = "<!-- ${comment} --><link name=\"l\"/>" + joint_text("j", "fixed", "base_link", "l");
  EXPECT_EQ(error_with(ros), "no error");
  ros.joint_rpy = "$(optenv RPY 0 0 0)";
  expect_part(error_with(ros), "<origin> is xacro");
}

}  // namespace
}  // namespace screed::urdf
