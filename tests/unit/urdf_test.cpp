// The URDF importer: frames, inertia, the motor rule, the Rover 5 model, and one clear line for
// every wrong file. Files are found from the project's root, where the tests run.
#include "host_sim/vehicle/urdf_importer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <locale>
#include <numbers>
#include <ostream>
#include <sstream>
#include <string>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

const std::string kSmall = "tests/data/urdf/small.urdf";
const std::string kRover = "boards/a_star_32u4/rover5.urdf";
constexpr double kPi = std::numbers::pi;

std::string contents(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// One folder for all tests of this process, gone when it ends.
class ModelFolder : public TempFolder {
 public:
  ModelFolder() {
    std::filesystem::copy_file("tests/data/urdf/unit_cube.obj", path() / "unit_cube.obj");
  }
};

std::string written_file() {
  static const ModelFolder folder;
  return folder.path() / "robot.urdf";
}

std::string write(const std::string& text) {
  std::ofstream(written_file(), std::ios::binary) << text;
  return written_file();
}

// The first `from` in small.urdf becomes `to`.
std::string small_with(const std::string& from, const std::string& to) {
  std::string text = contents(kSmall);
  const std::size_t place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  if (place != std::string::npos) text.replace(place, from.size(), to);
  return text;
}

std::string error_of_file(const std::string& file, const UrdfOptions& options = {}) {
  try {
    import_urdf(file, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string error_of(const std::string& text) {
  return error_of_file(write(text));
}

const AssemblyBody& body(const Assembly& assembly, const std::string& name) {
  return assembly.bodies.at(static_cast<std::size_t>(assembly.body_index(name)));
}

const AssemblyJoint& joint(const Assembly& assembly, const std::string& name) {
  return assembly.joints.at(static_cast<std::size_t>(assembly.joint_index(name)));
}

Eigen::Matrix3d box_tensor(double mass, const Eigen::Vector3d& size) {
  const Eigen::Vector3d squares = size.cwiseAbs2();
  return (mass / 12.0 * (Eigen::Vector3d::Constant(squares.sum()) - squares)).asDiagonal();
}

// About z.
Eigen::Matrix3d cylinder_tensor(double mass, double radius, double length) {
  const double across = mass * (3.0 * radius * radius + length * length) / 12.0;
  return Eigen::Vector3d(across, across, mass * radius * radius / 2.0).asDiagonal();
}

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
  const Assembly robot =
      import_urdf(write(small_with("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 3 -4\"/>")));
  EXPECT_TRUE(joint(robot, "fl_Wheel_joint").axis.isApprox(Eigen::Vector3d(0.0, 0.6, -0.8), 1e-12));
  const Assembly turned =
      import_urdf(write(small_with("<origin xyz=\"0.2 0.15 0\"/>",
                                   "<origin xyz=\"0.2 0.15 0\" rpy=\"0 0 1.5707963267948966\"/>")));
  EXPECT_TRUE(joint(turned, "fl_Wheel_joint").axis.isApprox(-Eigen::Vector3d::UnitX(), 1e-12));
  const Assembly without = import_urdf(write(small_with("<axis xyz=\"0 1 0\"/>", "")));
  EXPECT_EQ(joint(without, "fl_Wheel_joint").axis, Eigen::Vector3d::UnitX());
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
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  import_urdf(kSmall);
  error_of_file("tests/data/urdf/figure_5_4.urdf");
  error_of(small_with("<robot name=\"small\">", "<robot name=\"small\" version=\"7.3\">"));
  error_of(small_with("name=\"small\"", ""));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
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

// ---- What is refused ---------------------------------------------------------------------

struct Wrong {
  const char* name;
  const char* from;
  const char* to;
  const char* message;  // after the name of the file
};

void PrintTo(const Wrong& wrong, std::ostream* stream) {
  *stream << wrong.name;
}

class WrongUrdf : public testing::TestWithParam<Wrong> {};

TEST_P(WrongUrdf, IsRefusedInOneLine) {
  const std::string error = error_of(small_with(GetParam().from, GetParam().to));
  EXPECT_EQ(error, written_file() + GetParam().message);
  EXPECT_EQ(error.find('\n'), std::string::npos);
}

constexpr const char* kBodyInertia =
    "<inertia ixx=\"0.03\" ixy=\"0\" ixz=\"0\" iyy=\"0.04\" iyz=\"0\" izz=\"0.05\"/>";
constexpr const char* kBoxSize = "<box size=\"0.4 0.3 0.2\"/>";
constexpr const char* kFirstLimit =
    "<limit lower=\"-1\" upper=\"2\" effort=\"3\" velocity=\"0.5\"/>";
constexpr const char* kBase = "<link name=\"base\"/>";

const std::string kNoBody =
    "; a robot needs exactly one link each named Body, fl_Wheel, fr_Wheel, bl_Wheel, br_Wheel";

// ---- structure ---------------------------------------------------------------------------
INSTANTIATE_TEST_SUITE_P(
    Structure, WrongUrdf,
    testing::Values(
        Wrong{"TwoBodies", kBase, "<link name=\"Body\"/>",
              ":10: link 'Body' is there twice, first on line 4; names are unique"},
        Wrong{"TwoJointsOfOneName", "<joint name=\"fr_Wheel_joint\"",
              "<joint name=\"fl_Wheel_joint\"",
              ":38: joint 'fl_Wheel_joint' is there twice, first on line 24; names are unique"},
        Wrong{"NameOfTwoLines", "<parent link=\"base\"/>", "<parent link=\"ba\nse\"/>",
              ":5: joint 'base_joint': parent link 'ba se' does not exist"},
        Wrong{"NamelessLink", kBase, "<link/>", ":4: <link> needs a 'name'"},
        Wrong{"NamelessJoint", "<joint name=\"base_joint\"", "<joint",
              ":5: <joint> needs a 'name'"},
        Wrong{"UnknownParent", "<parent link=\"base\"/>", "<parent link=\"bass\"/>",
              ":5: joint 'base_joint': parent link 'bass' does not exist"},
        Wrong{"UnknownChild", "<child link=\"Box\"/>", "<child link=\"box\"/>",
              ":83: joint 'Box_joint': child link 'box' does not exist"},
        Wrong{"NoParent", "<parent link=\"base\"/>", "",
              ":5: joint 'base_joint': needs <parent link=\"...\"/>"},
        Wrong{"TwoParents", "<child link=\"fr_Wheel\"/>", "<child link=\"fl_Wheel\"/>",
              ":38: joint 'fr_Wheel_joint': link 'fl_Wheel' has two parents, joint "
              "'fl_Wheel_joint' and "
              "this one; a robot is a tree"},
        Wrong{"TwoRoots", kBase, "<link name=\"base\"/><link name=\"other\"/>",
              ":4: link 'other': neither this link nor link 'base' is the child of a joint; a "
              "robot is "
              "one tree"},
        Wrong{"CycleThroughBody", "<parent link=\"base\"/>", "<parent link=\"Box\"/>",
              ":10: link 'Body': its joints form a cycle; a robot is a tree"},
        Wrong{"CycleBesideTheTree", "</robot>",
              "<link name=\"a\"/><link name=\"b\"/>"
              "<joint name=\"ab\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>"
              "<joint name=\"ba\" type=\"fixed\"><parent link=\"b\"/><child "
              "link=\"a\"/></joint></robot>",
              ":88: link 'a': its joints form a cycle; a robot is a tree"},
        Wrong{"JointToItself", "<parent link=\"base\"/>", "<parent link=\"Body\"/>",
              ":10: link 'Body': its joints form a cycle; a robot is a tree"},
        Wrong{"Prismatic", "type=\"revolute\"", "type=\"prismatic\"",
              ":24: joint 'fl_Wheel_joint': type 'prismatic' is not supported; allowed: fixed, "
              "revolute, "
              "continuous"},
        Wrong{
            "UnknownJointType", "type=\"revolute\"", "type=\"hinge\"",
            ":24: joint 'fl_Wheel_joint': type 'hinge' is not supported; allowed: fixed, revolute, "
            "continuous"},
        Wrong{"NoJointType", "type=\"revolute\"", "",
              ":24: joint 'fl_Wheel_joint': type '' is not supported; allowed: fixed, revolute, "
              "continuous"},
        Wrong{"Mimic", kFirstLimit, "<mimic joint=\"fr_Wheel_joint\"/>",
              ":24: joint 'fl_Wheel_joint': <mimic> is not supported"},
        Wrong{
            "RevoluteWithoutLimit", kFirstLimit, "",
            ": not a valid URDF model: Joint [fl_Wheel_joint] is of type REVOLUTE but it does not "
            "specify limits"},
        Wrong{"NotARobot", "<robot name=\"small\">", "<sdf/><robot name=\"small\">",
              ": not a URDF file: the outermost element must be <robot>"},
        Wrong{"TwoRobots", "</robot>", "</robot><robot name=\"two\"/>",
              ":88: nothing may follow </robot>"},
        Wrong{"NamelessRobot", "<robot name=\"small\">", "<robot>",
              ": not a valid URDF model: No name given for the robot."}),
    [](const auto& test) { return test.param.name; });

// ---- values ------------------------------------------------------------------------------
INSTANTIATE_TEST_SUITE_P(
    Values, WrongUrdf,
    testing::Values(
        Wrong{"Sphere", kBoxSize, "<sphere radius=\"1\"/>",
              ":14: link 'Body': geometry <sphere> is not supported; allowed: box, cylinder, mesh"},
        Wrong{
            "Capsule", kBoxSize, "<capsule radius=\"1\" length=\"1\"/>",
            ":14: link 'Body': geometry <capsule> is not supported; allowed: box, cylinder, mesh"},
        Wrong{"NoShape", kBoxSize, "",
              ":12: link 'Body': <collision> needs a <geometry> with a box, cylinder or mesh"},
        Wrong{
            "ZeroSize", kBoxSize, "<box size=\"0.4 0 0.2\"/>",
            ":14: link 'Body': <box> 'size' is '0.4 0 0.2'; allowed: three positive finite numbers "
            "separated by spaces"},
        Wrong{"TwoSizes", kBoxSize, "<box size=\"0.4 0.2\"/>",
              ":14: link 'Body': <box> 'size' is '0.4 0.2'; allowed: three positive finite numbers "
              "separated by spaces"},
        Wrong{"CommaSize", kBoxSize, "<box size=\"0,4 0,3 0,2\"/>",
              ":14: link 'Body': <box> 'size' is '0,4 0,3 0,2'; allowed: three positive finite "
              "numbers "
              "separated by spaces"},
        Wrong{"NoSize", kBoxSize, "<box/>", ":14: link 'Body': <box> needs 'size'"},
        Wrong{"NegativeRadius", "radius=\"0.1\"", "radius=\"-0.1\"",
              ":21: link 'fl_Wheel': <cylinder> 'radius' is '-0.1'; allowed: one positive finite "
              "number"},
        Wrong{"NoLength", "length=\"0.05\"", "", ":21: link 'fl_Wheel': <cylinder> needs 'length'"},
        Wrong{"NegativeScale", "scale=\"0.1 0.2 0.3\"", "scale=\"0.1 -0.2 0.3\"",
              ":80: link 'Box': <mesh> 'scale' is '0.1 -0.2 0.3'; allowed: three positive finite "
              "numbers "
              "separated by spaces"},
        Wrong{"NotANumberMass", "mass value=\"2\"", "mass value=\"nan\"",
              ":11: link 'Body': <mass> 'value' is 'nan'; allowed: one positive finite number"},
        Wrong{"InfiniteMass", "mass value=\"2\"", "mass value=\"inf\"",
              ":11: link 'Body': <mass> 'value' is 'inf'; allowed: one positive finite number"},
        Wrong{"OverflowingMass", "mass value=\"2\"", "mass value=\"1e999\"",
              ":11: link 'Body': <mass> 'value' is '1e999'; allowed: one positive finite number"},
        Wrong{"ZeroMass", "mass value=\"2\"", "mass value=\"0\"",
              ":11: link 'Body': <mass> 'value' is '0'; allowed: one positive finite number"},
        Wrong{"NegativeMass", "mass value=\"2\"", "mass value=\"-2\"",
              ":11: link 'Body': <mass> 'value' is '-2'; allowed: one positive finite number"},
        Wrong{"MassWithUnit", "mass value=\"2\"", "mass value=\"%s%n kg\"",
              ":11: link 'Body': <mass> 'value' is '%s%n kg'; allowed: one positive finite number"},
        Wrong{"MassWithSpace", "mass value=\"2\"", "mass value=\"2 \"",
              ":11: link 'Body': <mass> 'value' is '2 '; allowed: one positive finite number"},
        Wrong{"NoMass", "<mass value=\"2\"/>", "", ":11: link 'Body': <inertial> needs <mass>"},
        Wrong{"NoInertia", kBodyInertia, "", ":11: link 'Body': <inertial> needs <inertia>"},
        Wrong{"NotANumberInertia", "ixx=\"0.03\"", "ixx=\"NaN\"",
              ":11: link 'Body': <inertia> 'ixx' is 'NaN'; allowed: one finite number"},
        Wrong{"IncompleteInertia", "izz=\"0.05\"", "", ":11: link 'Body': <inertia> needs 'izz'"},
        Wrong{"NegativeInertia", "ixx=\"0.03\"", "ixx=\"-0.03\"",
              ":11: link 'Body': <inertia> is not positive definite (principal moments -0.03, "
              "0.04, 0.05 "
              "kg m^2)"},
        Wrong{"IndefiniteInertia", "ixy=\"0\"", "ixy=\"0.07\"",
              ":11: link 'Body': <inertia> is not positive definite (principal moments -0.0351783, "
              "0.05, "
              "0.105178 kg m^2)"},
        Wrong{"TriangleInequality", "izz=\"0.05\"", "izz=\"0.071\"",
              ":11: link 'Body': <inertia> breaks the triangle inequality, the greatest moment "
              "exceeds the "
              "sum of the others (principal moments 0.03, 0.04, 0.071 kg m^2)"},
        Wrong{"ZeroAxis", "<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>",
              ":28: joint 'fl_Wheel_joint': <axis> is zero; it needs a direction"},
        Wrong{"EmptyAxis", "<axis xyz=\"0 1 0\"/>", "<axis/>",
              ":28: joint 'fl_Wheel_joint': <axis> needs 'xyz'"},
        Wrong{"NotANumberOrigin", "xyz=\"1 2 3\"", "xyz=\"1 nan 3\"",
              ":8: joint 'base_joint': <origin> 'xyz' is '1 nan 3'; allowed: three finite numbers "
              "separated by spaces"},
        Wrong{"LimitsReversed", "upper=\"2\"", "upper=\"-2\"",
              ":29: joint 'fl_Wheel_joint': <limit> lower -1 is above upper -2"},
        Wrong{"LimitWithoutVelocity", "velocity=\"0.5\"", "",
              ":29: joint 'fl_Wheel_joint': <limit> needs 'velocity'"},
        Wrong{"MovingLinkWithoutMass",
              "<link name=\"fl_Wheel\">\n    <inertial><mass value=\"0.5\"/><inertia ixx=\"1e-3\" "
              "ixy=\"0\" "
              "ixz=\"0\" iyy=\"2e-3\" iyz=\"0\" izz=\"1e-3\"/></inertial>",
              "<link name=\"fl_Wheel\">",
              ":17: link 'fl_Wheel': needs an <inertial> with a mass, here or on a link fixed to "
              "it: it "
              "moves on its own"},
        Wrong{"MissingMesh", "filename=\"unit_cube.obj\"", "filename=\"/gone.obj\"",
              ":73: link 'Box': mesh file '/gone.obj' does not exist or is not a file"},
        Wrong{"NamelessMesh", "filename=\"unit_cube.obj\"", "",
              ":80: link 'Box': <mesh> needs 'filename'"}),
    [](const auto& test) { return test.param.name; });

TEST(WrongFile, ExampleOfTheThesisHasNoBody) {
  EXPECT_EQ(error_of_file("tests/data/urdf/figure_5_4.urdf"),
            "tests/data/urdf/figure_5_4.urdf: there is no link named 'Body'" + kNoBody);
}

TEST(WrongFile, EachWheelIsNeeded) {
  for (const char* name : {"'fl_Wheel'", "'fr_Wheel'", "'bl_Wheel'", "'br_Wheel'"}) {
    std::string element = name;
    std::replace(element.begin(), element.end(), '\'', '"');
    const std::string error = error_of(small_with("<link name=" + element, "<link name=\"wheel\""));
    EXPECT_EQ(error.find(written_file() + ": there is no link named " + name + kNoBody), 0U)
        << error;
  }
}

TEST(WrongFile, MissingOrUnreadable) {
  EXPECT_EQ(error_of_file("gone.urdf"), "gone.urdf: no such file, or not a file");
  EXPECT_EQ(error_of_file("tests/data"), "tests/data: no such file, or not a file");
}

TEST(WrongFile, IsNoXml) {
  const std::string file = written_file();
  EXPECT_EQ(error_of(""), file + ": malformed XML: Error document empty.");
  EXPECT_NE(error_of("just text").find(file), std::string::npos);
  EXPECT_EQ(error_of(std::string("<robot\0/>", 9)), file + ": is not an XML text file");
  EXPECT_EQ(error_of(small_with("</link>", "")),
            file + ":88: malformed XML: Error reading end tag.");
}

TEST(WrongFile, EndlessNestingIsRefusedBeforeItCostsTheStack) {
  std::string deep;
  for (int i = 0; i < 1000000; ++i) deep += "<a>";
  EXPECT_EQ(error_of(deep), written_file() + ": elements are nested more than 100 deep");
}

TEST(WrongFile, EveryTruncationIsRefused) {
  const std::string text = contents(kSmall);
  const std::size_t complete = text.find("</robot>") + std::string("</robot>").size();
  for (std::size_t length = 0; length < complete; length += 3) {
    EXPECT_NE(error_of(text.substr(0, length)), "no error") << length;
  }
  EXPECT_NE(error_of(text.substr(0, complete - 1)), "no error");
  EXPECT_EQ(error_of(text.substr(0, complete)), "no error");
}

// ---- Rover 5 -----------------------------------------------------------------------------

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
}  // namespace screed
