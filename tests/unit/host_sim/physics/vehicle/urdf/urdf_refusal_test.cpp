// The URDF importer on files that are wrong: one clear line each.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>

#include "tests/unit/host_sim/physics/vehicle/urdf/urdf_fixture.h"

namespace screed::urdf {
namespace {

struct Wrong {
  const char* name;
  const char* from;
  const char* to;
  const char* message;  // after the name of the file
};

void PrintTo(const Wrong& wrong, std::ostream* stream) {
  *stream << wrong.name;
}

class WrongUrdf : public ::testing::TestWithParam<Wrong> {};

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

const std::string kHowToName =
    "; [vehicle] wheel_links = FRONT_LEFT FRONT_RIGHT REAR_LEFT REAR_RIGHT names the links";

// ---- structure ---------------------------------------------------------------------------
INSTANTIATE_TEST_SUITE_P(
    Structure, WrongUrdf,
    ::testing::Values(
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
    ::testing::Values(
        Wrong{"Capsule", kBoxSize, "<capsule radius=\"1\" length=\"1\"/>",
              ":14: link 'Body': geometry <capsule> is not supported; allowed: box, cylinder, "
              "sphere, mesh"},
        Wrong{"NegativeSphere", kBoxSize, "<sphere radius=\"-1\"/>",
              ":14: link 'Body': <sphere> 'radius' is '-1'; allowed: one positive finite number"},
        Wrong{"WheelOfABox", "<cylinder radius=\"0.1\" length=\"0.05\"/>",
              "<box size=\"0.1 0.1 0.1\"/>",
              ":17: link 'fl_Wheel': this wheel has no shape to roll on: a wheel needs a cylinder, "
              "a sphere or a mesh, in <collision> or else in <visual>"},
        Wrong{"NoShape", kBoxSize, "",
              ":12: link 'Body': <collision> needs a <geometry> with a box, cylinder, sphere "
              "or mesh"},
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
        Wrong{
            "NotANumberMass", "mass value=\"2\"", "mass value=\"nan\"",
            ":11: link 'Body': <mass> 'value' is 'nan'; allowed: one finite, not negative number"},
        Wrong{
            "InfiniteMass", "mass value=\"2\"", "mass value=\"inf\"",
            ":11: link 'Body': <mass> 'value' is 'inf'; allowed: one finite, not negative number"},
        Wrong{"OverflowingMass", "mass value=\"2\"", "mass value=\"1e999\"",
              ":11: link 'Body': <mass> 'value' is '1e999'; allowed: one finite, not negative "
              "number"},
        Wrong{
            "ZeroMass", "mass value=\"0.5\"", "mass value=\"0\"",
            ":17: link 'fl_Wheel': needs an <inertial> with a mass, here or on a link fixed to it: "
            "it moves on its own"},
        Wrong{"NegativeMass", "mass value=\"2\"", "mass value=\"-2\"",
              ":11: link 'Body': <mass> 'value' is '-2'; allowed: one finite, not negative number"},
        Wrong{"MassWithUnit", "mass value=\"2\"", "mass value=\"%s%n kg\"",
              ":11: link 'Body': <mass> 'value' is '%s%n kg'; allowed: one finite, not negative "
              "number"},
        Wrong{"MassWithSpace", "mass value=\"2\"", "mass value=\"2 \"",
              ":11: link 'Body': <mass> 'value' is '2 '; allowed: one finite, not negative number"},
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

TEST(WrongFile, EveryFaultIsNamedAtOnceInTheOrderOfLines) {
  std::string text = small_with("mass value=\"2\"", "mass value=\"two\"");
  const auto change = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  change("<axis xyz=\"0 1 0\"/>", "<axis/>");
  change("<child link=\"Box\"/>", "<child link=\"box\"/>");
  const std::string file = written_file();
  EXPECT_EQ(error_of(text),
            file +
                ":11: link 'Body': <mass> 'value' is 'two'; allowed: one finite, not negative "
                "number\n" +
                file + ":28: joint 'fl_Wheel_joint': <axis> needs 'xyz'\n" + file +
                ":83: joint 'Box_joint': child link 'box' does not exist");

  // Faults that show only when the values are read.
  text = small_with("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>");
  change("upper=\"2\"", "upper=\"-2\"");
  change("ixx=\"0.03\"", "ixx=\"0\"");
  change("filename=\"unit_cube.obj\"", "filename=\"gone.obj\"");
  const std::string error = error_of(text);
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 3) << error;
  for (const char* part : {":11: link 'Body': <inertia> is not pos", ":28: joint 'fl_Wheel_joint'",
                           ":29: joint 'fl_Wheel_joint': <limit> lower", "gone.obj"}) {
    EXPECT_NE(error.find(part), std::string::npos) << part << "\n" << error;
  }
}

TEST(WrongFile, AThousandFaultsAreCounted) {
  std::string text = "<robot name=\"r\">";
  for (int i = 0; i < 1000; ++i) text += "<link/>";
  const std::string error = error_of(text + "</robot>");
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 20);
  EXPECT_NE(error.find(written_file() + ": and 980 more"), std::string::npos) << error;
}

TEST(WrongFile, AMissingPackageIsNamedWithTheFoldersSearched) {
  const std::string folder = std::filesystem::path(written_file()).parent_path().string();
  const std::string error = error_of(
      small_with("filename=\"unit_cube.obj\"", "filename=\"package://bot/meshes/base.stl\""));
  EXPECT_TRUE(error.starts_with(written_file() +
                                ":73: link 'Box': mesh of package 'bot' is not "
                                "found: neither meshes/base.stl nor "
                                "bot/meshes/base.stl is in " +
                                folder + ", "))
      << error;
}

TEST(WrongFile, ExampleOfTheThesisHasNoWheels) {
  EXPECT_EQ(error_of_file("tests/data/urdf/figure_5_4.urdf"),
            "tests/data/urdf/figure_5_4.urdf: a robot needs four wheels; no link of a continuous "
            "joint has \"wheel\" in its name or its joint's (there is no continuous joint)" +
                kHowToName);
}

TEST(WrongFile, ARobotWithoutLinks) {
  EXPECT_EQ(error_of("<robot name=\"r\"/>"),
            written_file() + ": there is no <link>: a robot has some");
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
  const std::string text = read_text(kSmall);
  const std::size_t complete = text.find("</robot>") + std::string("</robot>").size();
  for (std::size_t length = 0; length < complete; length += 3) {
    EXPECT_NE(error_of(text.substr(0, length)), "no error") << length;
  }
  EXPECT_NE(error_of(text.substr(0, complete - 1)), "no error");
  EXPECT_EQ(error_of(text.substr(0, complete)), "no error");
}

}  // namespace
}  // namespace screed::urdf
