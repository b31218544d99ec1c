// `screed soil wheel` as a user meets it: limits of several slip angles, measurements of one's own.
#include <filesystem>
#include <string>

#include "host_sim/core/json.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

Json results_of(const std::string& out) {
  return Json::parse(out).at("results");
}

double value_of(const Json& results, const std::string& where, const char* name) {
  for (const Json& line : results) {
    if (line.at("where") == where && line.at("name") == name) return line.at("value").get<double>();
  }
  ADD_FAILURE() << "no " << name << " at " << where;
  return 0.0;
}

TEST_F(Program, SoilWheelGivesTheLimitAlone) {
  const Result run_ =
      run("soil wheel --limit-only --slip-angle 0,30 --slip -0.5,0.2 --charts out --json");
  ASSERT_EQ(run_.exit_code, 0) << run_.err;
  EXPECT_EQ(Json::parse(run_.out).at("test"), "wheel_limit");
  const Json limits = results_of(run_.out);
  for (const char* chart : {"sinkage", "pull", "side_force"}) {
    const std::string svg = read(root_ / "out" / (std::string("soil_limit_") + chart + ".svg"));
    EXPECT_NE(svg.find(">limit, 0 deg<"), std::string::npos) << chart;
    EXPECT_NE(svg.find(">limit, 30 deg<"), std::string::npos) << chart;
    EXPECT_NE(svg.find(">wheel r 30 mm, width 25 mm, load 3 N<"), std::string::npos) << chart;
  }
  // The limit that stands beside the engine.
  const Result engine = run("soil wheel --slip-angle 30 --slip 0.2 --duration 0.5 --json");
  ASSERT_EQ(engine.exit_code, 0) << engine.err;
  int compared = 0;
  for (const Json& line : results_of(engine.out)) {
    if (!line.contains("limit") || line.at("name") == "volume_error") continue;
    const std::string name = line.at("name").get<std::string>();
    EXPECT_EQ(line.at("where"), "slip 0.2") << "one slip angle is not named";
    EXPECT_EQ(line.at("limit").get<double>(), value_of(limits, "slip 0.2, angle 30", name.c_str()))
        << name;
    ++compared;
  }
  EXPECT_EQ(compared, 5);
  EXPECT_LT(value_of(limits, "slip -0.5, angle 0", "drawbar_pull_n"), 0.0);
}

TEST_F(Program, SoilWheelDrawsMeasurementsWithAndWithoutErrors) {
  const std::string head = "case,wheel_radius_m,wheel_width_m,load_n,slip,drawbar_pull_n";
  write("plain.csv", head + "\nmine_a,0.03,0.025,3,0.2,-0.2\n");
  write("errors.csv", head + ",drawbar_pull_error_n\nmine_a,0.03,0.025,3,0.2,-0.2,0.1\n");
  const auto svg = [&](const std::string& file) {
    const Result run_ =
        run("soil wheel --duration 0.5 --case mine --charts out --measured " + file);
    EXPECT_EQ(run_.exit_code, 0) << run_.err;
    return read(root_ / "out" / "soil_measured_mine_pull.svg");
  };
  EXPECT_NE(svg("plain.csv").find(">measured<"), std::string::npos);
  EXPECT_NE(svg("errors.csv").find(">measured, with the stated error<"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(root_ / "out" / "soil_measured_mine_sinkage.svg"))
      << "it was not measured";
  const Result both = run("soil wheel --limit-only --measured plain.csv --case mine");
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_NE(both.err.find("--limit-only"), std::string::npos) << both.err;
}

TEST_F(Program, SoilWheelStepsItsSlipOrFollowsASchedule) {
  const Result steps =
      run("soil wheel --soil cmu_2022 --speed 0.05 --duration 2 --slip-angle 0,90 --rim 0.05,0.2 "
          "--series steps.csv --json");
  ASSERT_EQ(steps.exit_code, 0) << steps.err;
  const Json lines = Json::parse(steps.out).at("results");
  ASSERT_EQ(lines.size(), 16U);
  EXPECT_NEAR(lines[0].at("value").get<double>(), lines[1].at("value").get<double>(), 0.1)
      << "without slip it stays as deep";
  EXPECT_GT(lines[5].at("value").get<double>(), lines[4].at("value").get<double>() + 1.0);
  EXPECT_EQ(read(root_ / "steps.csv").find("slip_angle_deg,rim_m_s,slip_path_m,steady,sinkage_m"),
            0U);

  write("drive.csv", "time_s,rim_m_s,travel_m_s\n0,0.05,0.05\n1,0.1,0.05\n");
  const Result belt =
      run("soil wheel --soil viper --schedule drive.csv --belt 0.1 --lug-height 0.002 "
          "--series belt.csv --charts out");
  ASSERT_EQ(belt.exit_code, 0) << belt.err;
  EXPECT_NE(read(root_ / "belt.csv").find("\n1.000,"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(root_ / "out" / "soil_schedule_sinkage.svg"));

  const Result spheres = run(
      "soil wheel --ground particles --particle-radius 0.012 --beds 2 --speed 0.1 --duration 0.5 "
      "--rim 0.2 --json");
  ASSERT_EQ(spheres.exit_code, 0) << spheres.err;
  const Json among = Json::parse(spheres.out);
  EXPECT_EQ(among.at("particles").at("beds"), 2);
  EXPECT_FALSE(among.contains("soil"));
  write("transient.csv",
        "case,wheel_radius_m,wheel_width_m,load_n,travel_m_s,rim_m_s,rim_time_constant_s,"
        "slip_path_m,extra_sinkage_m\nmine,0.03,0.025,3,0.1,0.2,0.05,0.02,0.001\n");
  const Result measured =
      run("soil wheel --ground particles --particle-radius 0.012 --beds 2 --case mine --measured "
          "transient.csv --json");
  ASSERT_EQ(measured.exit_code, 0) << measured.err;
  EXPECT_GT(value_of(results_of(measured.out), "mine, slip path 20 mm", "standard_error_mm"), 0.0);

  EXPECT_NE(run("soil wheel --belt 0.1").err.find("--schedule or --rim"), std::string::npos);
  EXPECT_NE(run("soil wheel --ground particles").err.find("--schedule or --rim"),
            std::string::npos);
  EXPECT_NE(run("soil wheel --beds 2").err.find("allowed is scm with one bed"), std::string::npos);
  EXPECT_NE(run("soil wheel --slip-angle 85").err.find("allowed is -80 to 80"), std::string::npos);
  EXPECT_EQ(run("soil wheel --rim 0.1 --limit-only").exit_code, 2);
}

}  // namespace
}  // namespace screed::testing
