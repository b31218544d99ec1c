// Robot models of one's own, as a user brings them: checked, driven, drawn.
#include <string>

#include "host_sim/core/json.h"
#include "host_sim/run/session/session_reader.h"
#include "tests/ros_robot.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

class ModelProgram : public Program {
 protected:
  Json checked(const std::string& arguments) const {
    const Result result = run("model check " + arguments + " --json");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? Json::parse(result.out) : Json();
  }
  /// How far an experiment's robot came to the east, m.
  double driven(const std::string& vehicle) const {
    write("e.ini", "[vehicle]\ntracks = false\n" + vehicle +
                       "\n[experiment]\nalgorithm = drive\nduration = 12\n[drive]\nspeed = 0.1\n");
    const Result result = run("sim e.ini --quiet --no-pictures --out run");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const SessionReader session(root_ / "run" / "session.h5");
    SimFrame frame;
    session.read(session.frames() - 1, std::span(&frame, 1));
    return frame.x;
  }
};

TEST_F(ModelProgram, TheTemplateIsFoundByNameAndHasNoWarnings) {
  const Result text = run("model check four_wheels");
  EXPECT_EQ(text.exit_code, 0) << text.err;
  for (const char* part :
       {"chassis         base_link", "mass            1.360 kg", "tread           195.0 mm",
        "wheelbase       180.0 mm", "rear_right_wheel_link", "collision cylinder", "no warnings"}) {
    EXPECT_NE(text.out.find(part), std::string::npos) << part << " in:\n" << text.out;
  }
  const Json model = checked("four_wheels");
  EXPECT_EQ(model["imu"]["link"], "imu_link");
  EXPECT_TRUE(model["warnings"].empty());
  ASSERT_EQ(model["wheels"].size(), 4U);
  EXPECT_EQ(model["wheels"][3]["corner"], "rear right");
  EXPECT_EQ(model["wheels"][3]["link"], "rear_right_wheel_link");
  EXPECT_EQ(model["wheels"][3]["radius_m"], 0.03);
  EXPECT_EQ(model["wheels"][3]["driven"], true);
}

TEST_F(ModelProgram, ExperimentsAreFoundByNameAsWell) {
  EXPECT_EQ(checked("first_drive")["robot"], "Dagu5");
  EXPECT_EQ(checked("first_drive"), checked("rover5"));
}

TEST_F(ModelProgram, TheTemplatesExperimentDrives) {
  const Result result = run("sim four_wheels --duration 11 --quiet --json --out run");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json summary = Json::parse(read(root_ / "run" / "summary.json"));
  EXPECT_GT(summary["distance_m"].get<double>(), 0.2) << summary.dump(1);
  EXPECT_GT(std::filesystem::file_size(root_ / "run" / "terrain_after.png"), 5000U);
}

// The firmware drives at the speed that it is told, whatever the names and the shapes.
TEST_F(ModelProgram, OrdinaryModelsDrive) {
  RosRobot named;
  named.has_footprint = true;
  named.limit = "<limit effort=\"5\" velocity=\"20\"/>";
  write("ros.urdf", urdf_of(named));
  const double expected = driven("model = ros.urdf");
  EXPECT_GT(expected, 0.4);
  EXPECT_LT(expected, 1.2);

  RosRobot spheres = named;
  spheres.wheel_shapes =
      "<collision><geometry><sphere radius=\"0.03\"/></geometry></collision><visual><origin "
      "rpy=\"1.5707963 0 0\"/><geometry><cylinder radius=\"0.03\" length=\"0.03\"/></geometry>"
      "</visual>";
  write("spheres.urdf", urdf_of(spheres));
  std::filesystem::remove_all(root_ / "run");
  EXPECT_NEAR(driven("model = spheres.urdf"), expected, 0.02);

  RosRobot meshes = named;  // about z of links that lie on their side
  meshes.joint_rpy = "-1.5707963267948966 0 0";
  meshes.axis = "0 0 1";
  meshes.wheel_shapes =
      "<collision><geometry><mesh filename=\"wheel.stl\" scale=\"0.001 0.001 0.001\"/></geometry>"
      "</collision>";
  write("wheel.stl", drum_stl(30.0, 30.0));
  write("meshes.urdf", urdf_of(meshes));
  std::filesystem::remove_all(root_ / "run");
  EXPECT_NEAR(driven("model = meshes.urdf"), expected, 0.02);
}

TEST_F(ModelProgram, AMappingNamesWhatNoRuleFinds) {
  RosRobot ros;
  ros.chassis = "hull";
  ros.wheels = {{{"lf", "j1", "0.09 0.0975 0"},
                 {"rf", "j2", "0.09 -0.0975 0"},
                 {"lr", "j3", "-0.09 0.0975 0"},
                 {"rr", "j4", "-0.09 -0.0975 0"}}};
  write("own.urdf", urdf_of(ros));
  expect_refused(run("model check own.urdf"), 2, {"own.urdf: a robot needs four wheels", "'rr'"});
  write("short.ini", "[vehicle]\nwheel_links = lf rf lr\n");
  expect_refused(run("sim short.ini"), 2, {"short.ini:2", "wheel_links", "front left"});
  expect_refused(run("model check own.urdf --wheel-links 'lf rf'"), 2, {"--wheel-links", "four"});
  EXPECT_EQ(checked("own.urdf --wheel-links 'lf, rf, lr, rr'")["wheels"][2]["link"], "lr");
  const double distance =
      driven("model = own.urdf\nchassis_link = hull\nwheel_links = lf rf lr rr");
  EXPECT_GT(distance, 0.4);
  EXPECT_EQ(checked("e.ini")["chassis"], "hull");
  // What was recorded names them again.
  const Result scene = run("render run --pov-only");
  EXPECT_EQ(scene.exit_code, 0) << scene.err;
}

TEST_F(ModelProgram, ARecordedRunFindsItsModelAboveItAndHere) {
  std::filesystem::create_directories(root_ / "mine");
  write("mine/own.urdf", urdf_of({}));
  write("mine/e.ini", "[vehicle]\nmodel = own.urdf\ntracks = false\n[experiment]\nduration = 1\n");
  const Result sim = run("sim mine/e.ini --quiet --no-pictures --heights --out mine/runs/r");
  ASSERT_EQ(sim.exit_code, 0) << sim.err;
  const Result above = run("render mine/runs/r --pov-only");
  EXPECT_EQ(above.exit_code, 0) << above.err;

  std::filesystem::rename(root_ / "mine" / "runs" / "r", root_ / "away");
  const Result gone = run("render away --pov-only");
  EXPECT_EQ(gone.exit_code, 2);
  EXPECT_NE(gone.err.find("'own.urdf': no such file"), std::string::npos) << gone.err;
  const Result here = run("render ../away --pov-only", "cd mine &&");
  EXPECT_EQ(here.exit_code, 0) << here.err;
  // Pictures are worth having without the robot, too.
  const Result exported = run("session export away --pictures --every 50");
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_NE(exported.err.find("note: the pictures are without the robot"), std::string::npos)
      << exported.err;
}

TEST_F(ModelProgram, ABoardThatDoesNotFitIsWarnedAbout) {
  RosRobot large;
  large.wheels[0].place = "0.25 0.3 0";
  large.wheels[1].place = "0.25 -0.3 0";
  large.wheels[2].place = "-0.25 0.3 0";
  large.wheels[3].place = "-0.25 -0.3 0";
  large.wheel_shapes =
      "<collision><origin rpy=\"1.5707963 0 0\"/><geometry><cylinder radius=\"0.18\" "
      "length=\"0.1\"/></geometry></collision>";
  large.extra = "<link name=\"load\">" + solid("50", "1");
  large.extra += "</link>" + joint_text("load_joint", "fixed", "base_link", "load");
  write("large.urdf", urdf_of(large));
  const std::string warnings = checked("large.urdf")["warnings"].dump();
  for (const char* part :
       {"counts distance for wheels of 30.0 mm: with 180.0 mm the robot drives 6.00 times",
        "steers for a tread of 195 mm; this one is 600 mm", "motors push with"}) {
    EXPECT_NE(warnings.find(part), std::string::npos) << part << " in: " << warnings;
  }
}

TEST_F(ModelProgram, WrongModelsAreRefusedInOneLine) {
  expect_refused(run("model check none.urdf"), 2, {"none.urdf: no such file"});
  expect_refused(run("model check no_such_robot"), 2,
                 {"no_such_robot: no such file", "first_drive", "robots", "four_wheels, rover5"});
  write("robot.urdf.xacro",
        "<robot name=\"r\" xmlns:xacro=\"x\"><xacro:macro name=\"m\"/></robot>");
  expect_refused(run("model check robot.urdf.xacro"), 2,
                 {"robot.urdf.xacro:1", "xacro robot.urdf.xacro > expanded.urdf"});
  RosRobot heavy;
  std::string text = urdf_of(heavy);
  text.replace(text.find("iyy=\"0.004\""), 11, "iyy=\"0.009\"");
  write("heavy.urdf", text);
  expect_refused(run("model check heavy.urdf"), 2, {"heavy.urdf:3", "triangle inequality"});
}

}  // namespace
}  // namespace screed::testing
