// The URDF importer on files that are right: frames, inertia, shapes, the motor rule, options.
#include <gtest/gtest.h>

#include <cmath>
#include <locale>
#include <ostream>
#include <sstream>
#include <string>

#include "tests/unit/host_sim/physics/vehicle/urdf/urdf_fixture.h"

namespace screed::urdf {
namespace {

// ---- Inertia -----------------------------------------------------------------------------

TEST(Inertia, TwoHalvesOfABoxAreTheBox) {
  const Eigen::Vector3d half_size(0.2, 0.3, 0.5);
  Inertia left{1.5, Eigen::Isometry3d(Eigen::Translation3d(1.0, 2.0, 3.0)),
               box_tensor(1.5, half_size)};
  Inertia right = left;
  right.pose.translation().x() += 0.2;
  const Inertia whole = compose({left, right});
  EXPECT_DOUBLE_EQ(whole.mass, 3.0);
  EXPECT_TRUE(whole.pose.translation().isApprox(Eigen::Vector3d(1.1, 2.0, 3.0), 1e-12));
  EXPECT_TRUE(whole.pose.linear().isIdentity());
  EXPECT_TRUE(whole.tensor.isApprox(box_tensor(3.0, {0.4, 0.3, 0.5}), 1e-12));
}

TEST(Inertia, UnequalTurnedPiecesOfABoxAreTheBox) {
  // A box 0.8 x 0.3 x 0.5 of 4 kg, cut at x = 0.2; the small piece is described in axes turned by
  // 90 degrees about z.
  Inertia large{3.0, Eigen::Isometry3d(Eigen::Translation3d(0.5, 0.0, 0.0)),
                box_tensor(3.0, {0.6, 0.3, 0.5})};
  Inertia small{1.0, Eigen::Isometry3d(Eigen::Translation3d(0.1, 0.0, 0.0)),
                box_tensor(1.0, {0.3, 0.2, 0.5})};
  small.pose.rotate(Eigen::AngleAxisd(kPi / 2.0, Eigen::Vector3d::UnitZ()));
  const Inertia whole = compose({large, small});
  EXPECT_TRUE(whole.pose.translation().isApprox(Eigen::Vector3d(0.4, 0.0, 0.0), 1e-12));
  EXPECT_TRUE(whole.tensor.isApprox(box_tensor(4.0, {0.8, 0.3, 0.5}), 1e-12));
}

TEST(Inertia, MasslessPartsAddNothing) {
  const Inertia cube{2.0, Eigen::Isometry3d(Eigen::Translation3d(0.0, 1.0, 0.0)),
                     box_tensor(2.0, {1.0, 1.0, 1.0})};
  Inertia frame;
  frame.pose.translation() = Eigen::Vector3d(5.0, 5.0, 5.0);
  const Inertia whole = compose({frame, cube});
  EXPECT_TRUE(whole.pose.isApprox(cube.pose));
  EXPECT_TRUE(whole.tensor.isApprox(cube.tensor));
  EXPECT_EQ(compose({frame}).mass, 0.0);
  EXPECT_EQ(compose({}).mass, 0.0);
}

// ---- What is read ------------------------------------------------------------------------

TEST(Urdf, EverythingIsInTheFrameOfBodyAlsoWhenItIsNotTheRoot) {
  const Assembly robot = import_urdf(kSmall);
  EXPECT_EQ(robot.name, "small");
  EXPECT_TRUE(body(robot, "Body").pose.isApprox(Eigen::Isometry3d::Identity(), 1e-12));
  EXPECT_TRUE(
      body(robot, "fl_Wheel").pose.translation().isApprox(Eigen::Vector3d(0.2, 0.15, 0.0), 1e-12));
  // The base is 1, 2, 3 back along its own axes, which are turned to the right as seen from Body.
  const Eigen::Isometry3d& base = body(robot, "base").pose;
  EXPECT_TRUE(base.translation().isApprox(Eigen::Vector3d(-2.0, 1.0, -3.0), 1e-12));
  EXPECT_TRUE(
      (base.linear() * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(Urdf, BodiesAndJointsKeepTheOrderOfTheFile) {
  const Assembly robot = import_urdf(kSmall);
  ASSERT_EQ(robot.bodies.size(), 7U);
  EXPECT_EQ(robot.bodies[0].name, "base");
  EXPECT_EQ(robot.bodies[1].name, "Body");
  EXPECT_EQ(robot.bodies[6].name, "Box");
  ASSERT_EQ(robot.joints.size(), 6U);
  EXPECT_EQ(robot.joints[1].name, "fl_Wheel_joint");
  EXPECT_EQ(robot.joints[1].parent, 1);
  EXPECT_EQ(robot.joints[1].child, 2);
  EXPECT_EQ(robot.body_index("nobody"), -1);
  EXPECT_EQ(robot.joint_index("nobody"), -1);
}

TEST(Urdf, RollPitchYawTurnAboutFixedAxesInThatOrder) {
  const Assembly robot = import_urdf(
      write(small_with("xyz=\"0 0 0.01\"", "xyz=\"0.1 0.2 0.3\" rpy=\"0.3 -0.5 1.1\"")));
  const Shape& shape = body(robot, "Body").collision.at(0);
  const Eigen::Matrix3d expected = (Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(-0.5, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  EXPECT_TRUE(shape.pose.linear().isApprox(expected, 1e-12));
  EXPECT_TRUE(shape.pose.translation().isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
}

TEST(Urdf, ShapesAndInertiaAreTakenOver) {
  const Assembly robot = import_urdf(kSmall);
  EXPECT_EQ(std::get<Box>(body(robot, "Body").collision.at(0).geometry).size,
            Eigen::Vector3d(0.4, 0.3, 0.2));
  EXPECT_TRUE(body(robot, "Body").visual.empty());
  const auto& wheel = std::get<Cylinder>(body(robot, "br_Wheel").collision.at(0).geometry);
  EXPECT_EQ(wheel.radius, 0.1);
  EXPECT_EQ(wheel.length, 0.05);
  const AssemblyBody& box = body(robot, "Box");
  EXPECT_EQ(box.inertia.mass, 1.0);
  EXPECT_EQ(box.inertia.pose.translation(), Eigen::Vector3d(0.0, 0.0, 0.5));
  EXPECT_EQ(box.inertia.tensor(0, 1), 0.01);
  EXPECT_EQ(box.inertia.tensor(1, 0), 0.01);
  const auto& mesh = std::get<TriangleMesh>(box.visual.at(0).geometry);
  Eigen::Vector3d greatest = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& v : mesh.vertices) greatest = greatest.cwiseMax(v);
  EXPECT_TRUE(greatest.isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
}

TEST(Urdf, PackageNamesAreRelativeToTheFile) {
  const Assembly robot = import_urdf(write(
      small_with("filename=\"unit_cube.obj\"", "filename=\"package://small/unit_cube.obj\"")));
  EXPECT_EQ(std::get<TriangleMesh>(body(robot, "Box").visual.at(0).geometry).vertices.size(), 8U);
}

TEST(Urdf, VelocityLimitOfOneMakesAMotor) {
  using Kind = AssemblyJoint::Kind;
  const Assembly robot = import_urdf(kSmall);
  const AssemblyJoint& revolute = joint(robot, "fl_Wheel_joint");
  EXPECT_EQ(revolute.kind, Kind::Revolute);
  EXPECT_TRUE(revolute.limited);
  EXPECT_EQ(revolute.lower_rad, -1.0);
  EXPECT_EQ(revolute.upper_rad, 2.0);
  EXPECT_EQ(revolute.effort_n_m, 3.0);
  const AssemblyJoint& motor = joint(robot, "fr_Wheel_joint");
  EXPECT_EQ(motor.kind, Kind::Motor);
  EXPECT_FALSE(motor.limited);
  EXPECT_EQ(motor.effort_n_m, 4.0);
  EXPECT_EQ(joint(robot, "bl_Wheel_joint").kind, Kind::Revolute);
  EXPECT_FALSE(joint(robot, "bl_Wheel_joint").limited);
  EXPECT_EQ(joint(robot, "Box_joint").kind, Kind::Fixed);

  // The thesis' own form: type revolute, with limits that a motor does not stop at.
  const Assembly thesis = import_urdf(write(small_with("velocity=\"0.5\"", "velocity=\"1\"")));
  EXPECT_EQ(joint(thesis, "fl_Wheel_joint").kind, Kind::Motor);
  EXPECT_FALSE(joint(thesis, "fl_Wheel_joint").limited);
  // A fixed joint has no motor.
  const Assembly fixed = import_urdf(write(small_with("type=\"continuous\"", "type=\"fixed\"")));
  EXPECT_EQ(joint(fixed, "fr_Wheel_joint").kind, Kind::Fixed);
}

TEST(Urdf, AxisBecomesUnitLengthInTheFrameOfBody) {
  const auto box_joint = [](const std::string& inside) {
    std::string text = small_with("<joint name=\"Box_joint\" type=\"fixed\">",
                                  "<joint name=\"Box_joint\" type=\"continuous\">");
    const std::string origin = "<origin xyz=\"0 0 0.1\"/>";
    text.replace(text.find(origin), origin.size(), inside);
    return joint(import_urdf(write(text)), "Box_joint");
  };
  EXPECT_TRUE(box_joint("<origin xyz=\"0 0 0.1\"/><axis xyz=\"0 3 -4\"/>")
                  .axis.isApprox(Eigen::Vector3d(0.0, 0.6, -0.8), 1e-12));
  EXPECT_TRUE(box_joint("<origin rpy=\"0 0 1.5707963267948966\"/><axis xyz=\"0 1 0\"/>")
                  .axis.isApprox(-Eigen::Vector3d::UnitX(), 1e-12));
  EXPECT_EQ(box_joint("").axis, Eigen::Vector3d::UnitX());
}

// SolidWorks writes both for a mere place, such as a sensor's.
TEST(Urdf, AFixedLinkMayHaveAZeroAxisAndNoMass) {
  const std::string zero =
      "<link name=\"sonar\"><inertial><mass value=\"0\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" "
      "iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link><joint name=\"sonar_joint\" "
      "type=\"fixed\"><parent link=\"Body\"/><child link=\"sonar\"/><axis xyz=\"0 0 0\"/></joint>";
  const std::string file = write(small_with("</robot>", zero + "</robot>"));
  const Assembly robot = import_urdf(file);
  EXPECT_EQ(body(robot, "sonar").inertia.mass, 0.0);
  EXPECT_EQ(joint(robot, "sonar_joint").kind, AssemblyJoint::Kind::Fixed);
  EXPECT_DOUBLE_EQ(composed_inertia(robot, rigid_group(robot, 1)).mass, 3.0);
  UrdfOptions options;
  options.joint_angles_rad["sonar_joint"] = 0.0;
  EXPECT_NE(error_of_file(file, options).find("has no <axis> to turn it about"), std::string::npos);
}

TEST(Urdf, RigidGroupsFollowFixedJointsBothWays) {
  const Assembly robot = import_urdf(kSmall);
  const std::vector<int> expected = {0, 1, 6};  // base, Body, Box
  for (const int member : expected) EXPECT_EQ(rigid_group(robot, member), expected);
  EXPECT_EQ(rigid_group(robot, 3), std::vector<int>{3});
  const Inertia chassis = composed_inertia(robot, expected);
  EXPECT_DOUBLE_EQ(chassis.mass, 3.0);
  EXPECT_TRUE(chassis.pose.translation().isApprox(Eigen::Vector3d(0.0, 0.0, 0.2), 1e-12));
  // By hand: 0.03 + 0.1 + 2 * 0.2^2 + 1 * 0.4^2.
  EXPECT_NEAR(chassis.tensor(0, 0), 0.37, 1e-12);
  EXPECT_NEAR(chassis.tensor(0, 1), 0.01, 1e-12);
  EXPECT_NEAR(chassis.tensor(2, 2), 0.15, 1e-12);
}

TEST(Urdf, JointsCanBeHeldAtAnAngle) {
  UrdfOptions options;
  options.joint_angles_rad["fl_Wheel_joint"] = 0.5;
  const Assembly robot = import_urdf(kSmall, options);
  EXPECT_EQ(joint(robot, "fl_Wheel_joint").kind, AssemblyJoint::Kind::Fixed);
  const Eigen::Matrix3d expected =
      Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_TRUE(body(robot, "fl_Wheel").pose.linear().isApprox(expected, 1e-12));
}

TEST(Urdf, OptionsThatDoNotFitAreRefused) {
  const auto error_with = [](const std::string& name, double angle_rad) {
    UrdfOptions options;
    options.joint_angles_rad[name] = angle_rad;
    return error_of_file(kSmall, options);
  };
  EXPECT_EQ(error_with("gone", 0.0), kSmall + ": there is no joint named 'gone' to hold");
  EXPECT_EQ(error_with("Box_joint", 0.1),
            kSmall + ":83: joint 'Box_joint': has no <axis> to turn it about");
  EXPECT_EQ(error_with("fl_Wheel_joint", 2.1),
            kSmall + ":24: joint 'fl_Wheel_joint': cannot be held at 2.1 rad; allowed: -1 to 2");
  EXPECT_NE(error_with("fl_Wheel_joint", std::nan("")).find("is not finite"), std::string::npos);
  UrdfOptions leg;
  leg.leg_angle_rad = 0.1;
  EXPECT_EQ(error_of_file(kSmall, leg),
            kSmall + ": the leg angle cannot be set: there is no joint named 'fl_Leg_joint'");
}

// Decimal comma, groups of three: what a German desktop sets.
class CommaLocale : public std::numpunct<char> {
 protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Urdf, LocaleDoesNotMatter) {
  const std::locale before =
      std::locale::global(std::locale(std::locale::classic(), new CommaLocale));
  const Assembly robot = import_urdf(kSmall);
  const std::string error = error_of(small_with("mass value=\"2\"", "mass value=\"-2.5\""));
  std::locale::global(before);
  EXPECT_EQ(std::get<Box>(body(robot, "Body").collision.at(0).geometry).size,
            Eigen::Vector3d(0.4, 0.3, 0.2));
  EXPECT_EQ(std::get<TriangleMesh>(body(robot, "Box").visual.at(0).geometry).vertices.size(), 8U);
  EXPECT_NE(error.find("robot.urdf:11: link 'Body'"), std::string::npos) << error;
}

TEST(Urdf, NothingIsPrinted) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  import_urdf(kSmall);
  error_of_file("tests/data/urdf/figure_5_4.urdf");
  error_of(small_with("<robot name=\"small\">", "<robot name=\"small\" version=\"7.3\">"));
  error_of(small_with("name=\"small\"", ""));
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(Urdf, ExtensionsOfOtherToolsAndColoursAreIgnored) {
  // urdfdom 3.0.1 would take the name of a material without colour for a printf format.
  const Assembly robot = import_urdf(
      write(small_with("<link name=\"base\"/>",
                       "<material name=\"%s%n%s%n\"/><gazebo><link name=\"x\"/></gazebo>"
                       "<link name=\"base\"><visual><geometry><box size=\"1 1 1\"/></geometry>"
                       "<material name=\"%n\"><color rgba=\"red\"/></material></visual></link>")));
  EXPECT_EQ(robot.bodies.size(), 7U);
}

}  // namespace
}  // namespace screed::urdf
