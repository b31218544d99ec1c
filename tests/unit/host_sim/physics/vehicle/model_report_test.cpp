// Figures and warnings of a robot model.
#include "host_sim/physics/vehicle/model_report.h"

#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "host_sim/core/data_folders.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "tests/ros_robot.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

using testing::joint_text;
using testing::RosRobot;
using testing::solid;

ModelReport report_of(const RosRobot& robot) {
  const TempFolder folder;
  write_text(folder.path() / "robot.urdf", testing::urdf_of(robot));
  return report_model(import_urdf(folder.path() / "robot.urdf"));
}

/// The warnings, a line each.
std::string warnings_of(const RosRobot& robot) {
  std::string lines;
  for (const std::string& line : report_of(robot).warnings) lines += line + "\n";
  return lines;
}

TEST(ModelReport, HasTheFiguresOfARobot) {
  RosRobot ros;
  ros.extra =
      "<link name=\"imu_link\"/>" +
      joint_text("imu_joint", "fixed", "base_link", "imu_link", "<origin xyz=\"0.01 0.02 0.03\"/>");
  const ModelReport report = report_of(ros);
  EXPECT_DOUBLE_EQ(report.mass_kg, 1.4);
  EXPECT_TRUE(report.centre.isZero(1e-12));
  // Four wheels of 0.1 kg at (0.09, 0.0975).
  EXPECT_NEAR(report.inertia(0, 0), 0.004 + 4 * (5e-5 + 0.1 * 0.0975 * 0.0975), 1e-12);
  EXPECT_NEAR(report.inertia(2, 2), 0.004 + 4 * (5e-5 + 0.1 * (0.09 * 0.09 + 0.0975 * 0.0975)),
              1e-12);
  EXPECT_TRUE(report.imu.isApprox(Eigen::Vector3d(0.01, 0.02, 0.03)));
  EXPECT_DOUBLE_EQ(report.tread_m, 0.195);
  EXPECT_DOUBLE_EQ(report.wheelbase_m, 0.18);
  EXPECT_NEAR(report.clearance_m, 0.005, 1e-12);
  EXPECT_EQ(warnings_of(ros), "");
}

TEST(ModelReport, TheRobotsThatComeWithScreedHaveNoWarnings) {
  for (const auto& folder : {data_folders().data / "robots", data_folders().boards}) {
    int count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (entry.path().extension() != ".urdf") continue;
      EXPECT_TRUE(report_model(import_urdf(entry.path())).warnings.empty()) << entry.path();
      ++count;
    }
    EXPECT_GT(count, 0) << folder;
  }
}

struct Doubt {
  const char* name;
  void (*make)(RosRobot& robot);
  const char* warning;
};

void PrintTo(const Doubt& doubt, std::ostream* stream) {
  *stream << doubt.name;
}

class DoubtfulModel : public ::testing::TestWithParam<Doubt> {};

TEST_P(DoubtfulModel, IsWarnedAbout) {
  RosRobot ros;
  GetParam().make(ros);
  EXPECT_NE(warnings_of(ros).find(GetParam().warning), std::string::npos) << warnings_of(ros);
}

INSTANTIATE_TEST_SUITE_P(
    Each, DoubtfulModel,
    ::testing::Values(
        Doubt{"WheelHeights", [](RosRobot& r) { r.wheels[3].place = "-0.09 -0.0975 0.01"; },
              "the wheels' bottoms are not at one height: 'rear_right_wheel_link' -20.0 mm, "
              "'front_left_wheel_link' -30.0 mm\n"},
        Doubt{"VisualOnly",
              [](RosRobot& r) {
                r.wheel_shapes =
                    "<visual><origin rpy=\"1.5707963 0 0\"/><geometry><cylinder radius=\"0.03\" "
                    "length=\"0.03\"/></geometry></visual>";
              },
              "wheel 'front_left_wheel_link' has no collision shape: it rolls on its visual "
              "cylinder\n"},
        Doubt{"Tread", [](RosRobot& r) { r.wheels[2].place = "-0.09 0.1175 0"; },
              "the tread is 195.0 mm in front and 215.0 mm behind\n"},
        Doubt{"Wheelbase", [](RosRobot& r) { r.wheels[2].place = "-0.07 0.0975 0"; },
              "the wheelbase is 160.0 mm on the left and 180.0 mm on the right\n"},
        Doubt{"Aside",
              [](RosRobot& r) {
                r.wheels[0].place = "0.09 0.1175 0";
                r.wheels[2].place = "-0.09 0.1175 0";
              },
              "the origin of the chassis is 10.0 mm beside the middle of the wheels\n"},
        Doubt{
            "Name", [](RosRobot& r) { std::swap(r.wheels[0].place, r.wheels[3].place); },
            "wheel 'front_left_wheel_link' is the rear right one by its place, not by its name\n"},
        Doubt{"TwoCarriers",
              [](RosRobot& r) {
                r.extra = "<link name=\"bogie\">" + solid("0.1", "1e-4");
                r.extra += "</link>" + joint_text("swing", "continuous", "base_link", "bogie",
                                                  "<origin xyz=\"-0.09 0 0\"/>");
                r.parents = {"base_link", "base_link", "bogie", "bogie"};
                r.wheels[2].place = "0 0.0975 0";
                r.wheels[3].place = "0 -0.0975 0";
              },
              "with [vehicle] tracks = true it is refused: robot model: a track needs "
              "'front_left_wheel_link' and 'rear_left_wheel_link' on the same rigid body"},
        Doubt{"Hull", [](RosRobot& r) { r.chassis_size = "0.2 0.14 0.08"; },
              "a collision shape reaches 10.0 mm below the wheels"},
        Doubt{"Balance",
              [](RosRobot& r) {
                r.extra = "<link name=\"load\">" + solid("10", "0.01");
                r.extra += "</link>" + joint_text("load_joint", "fixed", "base_link", "load",
                                                  "<origin xyz=\"0.2 0 0\"/>");
              },
              "is not over the wheels: the robot tips over\n"},
        Doubt{"Inertia",
              [](RosRobot& r) {
                r.extra = "<link name=\"box\">" + solid("0.1", "1");
                r.extra +=
                    "<visual><geometry><sphere radius=\"0.05\"/></geometry></visual></link>" +
                    joint_text("box_joint", "fixed", "base_link", "box");
              },
              "link 'box' has the inertia of a body far larger than it is: radius of gyration "
              "3162 mm, extent 100 mm\n"},
        Doubt{"LightLink",
              [](RosRobot& r) {
                r.extra = "<link name=\"whisker\">" + solid("0.002", "1e-7");
                r.extra +=
                    "</link>" + joint_text("whisker_joint", "continuous", "base_link", "whisker");
              },
              "what hangs on joint 'whisker_joint' has 0.14 % of the robot's mass: particles throw "
              "up what has less than 0.5 %; fix it, or make it heavier"},
        Doubt{"FreeJoint",
              [](RosRobot& r) {
                r.extra = "<link name=\"arm\">" + solid("0.1", "1e-4");
                r.extra += "</link>" + joint_text("shoulder", "continuous", "base_link", "arm");
              },
              "joint 'shoulder' swings freely: nothing holds or drives it"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace screed
