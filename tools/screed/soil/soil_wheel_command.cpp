// `screed soil wheel`: a wheel beside its limit and beside measurements.
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <numbers>

#include "host_sim/core/data_folders.h"
#include "host_sim/render/chart/line_chart.h"
#include "host_sim/soil_validation/soil_measurements.h"
#include "host_sim/soil_validation/wheel_testbed.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/soil/soil_common.h"

namespace screed {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct WheelArguments {
  SoilArguments common;
  WheelTest test;
  double yaw_deg = 0.0;
  std::vector<double> slips = {0.0, 0.2, 0.4};
  std::string measured;
  std::string cases = "ding2011_smooth";
  double slip_angle_deg = 0.0;
  double rim_friction_deg = 90.0;
};

/// Chrono's SCM (exact rays) for Ding's wheel: slip, drawbar pull N, sinkage m
/// (docs/measurements/soil.md).
struct PeerWheel {
  double slip;
  double drawbar_pull_n;
};
constexpr PeerWheel kPeerDing[] = {{0.1, 11.2}, {0.2, 23.9}, {0.3, 33.8}, {0.4, 41.2}, {0.6, 49.2}};

void chart_wheel(const WheelArguments& a, const char* file, const std::string& title,
                 const char* y_label, const std::vector<ChartSeries>& series) {
  Chart chart;
  chart.title = title;
  chart.x_label = "slip [1]";
  chart.y_label = y_label;
  chart.series = series;
  write_chart(a.common.chart(file), chart);
}

std::string wheel_words(const WheelArguments& a) {
  const RollingWheel& w = a.test.wheel;
  return a.common.soil().name + text(", wheel r %g", w.radius_m * kMilli) +
         text(" mm, width %g mm", w.width_m * kMilli) + text(", load %g N", w.load_n) +
         text(", grid %g mm", a.common.cell_m * kMilli) +
         text(", step %g ms", a.common.step_s * kMilli) + ", normal stress " +
         a.common.normal_stress;
}

int run_measured(WheelArguments a) {
  const std::vector<MeasuredWheel> rows = read_soil_measurements(a.measured, a.cases).wheels;
  const NormalStress stress = a.test.options.normal_stress;
  const RollingWheel rim = a.test.wheel;
  std::vector<SoilLine> lines;
  ChartSeries sinkage[3] = {{"Screed", {}, true}, {"limit", {}, false}, {"measured", {}, true}};
  ChartSeries pull[4] = {
      {"Screed", {}, true}, {"limit", {}, false}, {"measured", {}, true}, {"Chrono", {}, true}};
  ProgressBar bar(std::cerr);
  for (const MeasuredWheel& row : rows) {
    bar.show_share(static_cast<double>(&row - rows.data()) / static_cast<double>(rows.size()),
                   "rolling a wheel");
    a.test.wheel = row.wheel;
    a.test.wheel.friction = rim.friction;
    a.test.wheel.adhesion_pa = rim.adhesion_pa;
    const WheelPass pass = run_wheel(a.test).passes[0];
    const WheelReaction limit = wheel_limit(a.test.wheel, a.test.soil, stress);
    std::string where = text("slip %g", row.wheel.slip);
    if (row.wheel.slip_angle_rad != 0.0)
      where += text(", angle %g", row.wheel.slip_angle_rad / kDegree);
    std::optional<double> peer;
    for (const PeerWheel& known : kPeerDing) {
      if (a.cases == "ding2011_smooth" && std::abs(known.slip - row.wheel.slip) < 1e-9) {
        peer = known.drawbar_pull_n;
        pull[3].points.push_back({known.slip, *peer});
      }
    }
    const auto measured_mm = [](std::optional<double> m) {
      return m ? std::optional(*m * kMilli) : std::nullopt;
    };
    lines.push_back({where, "sinkage_mm", pass.sinkage_m * kMilli, "%.2f",
                     measured_mm(row.sinkage_m), SoilLine::Error::kRelative,
                     peer ? std::optional(8.65) : std::nullopt});
    lines.push_back({where, "drawbar_pull_n", pass.drawbar_pull_n, "%.2f", row.drawbar_pull_n,
                     SoilLine::Error::kAbsolute, peer});
    lines.push_back({where, "side_force_n", pass.side_force_n, "%.2f", row.side_force_n,
                     SoilLine::Error::kAbsolute});
    lines.push_back(
        {where, "torque_nm", pass.torque_nm, "%.2f", row.torque_nm, SoilLine::Error::kRelative});
    sinkage[0].points.push_back({row.wheel.slip, pass.sinkage_m * kMilli});
    sinkage[1].points.push_back({row.wheel.slip, limit.sinkage_m * kMilli});
    if (row.sinkage_m) sinkage[2].points.push_back({row.wheel.slip, *row.sinkage_m * kMilli});
    pull[0].points.push_back({row.wheel.slip, pass.drawbar_pull_n});
    pull[1].points.push_back({row.wheel.slip, limit.drawbar_pull_n});
    if (row.drawbar_pull_n) pull[2].points.push_back({row.wheel.slip, *row.drawbar_pull_n});
  }
  bar.clear();
  if (!a.common.charts.empty()) {
    chart_wheel(a, "soil_measured_sinkage.svg", "Sinkage of a wheel, measured and simulated",
                "sinkage [mm]", {sinkage[0], sinkage[1], sinkage[2]});
    std::vector<ChartSeries> pulls = {pull[0], pull[1], pull[2]};
    if (!pull[3].points.empty()) pulls.push_back(pull[3]);
    chart_wheel(a, "soil_measured_pull.svg", "Drawbar pull of a wheel, measured and simulated",
                "drawbar pull [N]", pulls);
  }
  return finish(a.common, "wheel", wheel_words(a), "measured", lines);
}

int run_wheel_command(WheelArguments a) {
  a.test.soil = a.common.soil();
  a.test.options = a.common.options();
  a.test.cell_m = a.common.cell_m;
  a.test.step_s = a.common.step_s;
  a.test.yaw_rad = a.yaw_deg * kDegree;
  a.test.wheel.slip_angle_rad = a.slip_angle_deg * kDegree;
  a.test.wheel.friction = a.rim_friction_deg >= 90.0 ? std::numeric_limits<double>::infinity()
                                                     : std::tan(a.rim_friction_deg * kDegree);
  if (!a.measured.empty()) return run_measured(a);
  std::vector<SoilLine> lines;
  ChartSeries sinkage[2] = {{"Screed", {}, true}, {"limit", {}, false}};
  ChartSeries pull[2] = {{"Screed", {}, true}, {"limit", {}, false}};
  ProgressBar bar(std::cerr);
  for (const double& slip : a.slips) {
    bar.show_share(
        static_cast<double>(&slip - a.slips.data()) / static_cast<double>(a.slips.size()),
        "rolling a wheel");
    a.test.wheel.slip = slip;
    const WheelTestResult result = run_wheel(a.test);
    RollingWheel rolling = a.test.wheel;
    for (size_t i = 0; i < result.passes.size(); ++i) {
      const WheelPass& pass = result.passes[i];
      std::string where = text("slip %g", slip);
      if (result.passes.size() > 1) where += ", pass " + std::to_string(i + 1);
      const WheelReaction limit = wheel_limit(rolling, a.test.soil, a.test.options.normal_stress);
      rolling.rut_m = limit.rut_m;
      // The limit is that of soil that stays where it is.
      const auto unmoved = [&](double value) {
        return a.common.bulldozing ? std::nullopt : std::optional(value);
      };
      lines.push_back({where, "sinkage_mm", pass.sinkage_m * kMilli, "%.4f",
                       unmoved(limit.sinkage_m * kMilli), SoilLine::Error::kRelative});
      lines.push_back({where, "drawbar_pull_n", pass.drawbar_pull_n, "%.5f",
                       unmoved(limit.drawbar_pull_n), SoilLine::Error::kAbsolute});
      if (rolling.slip_angle_rad != 0.0) {
        lines.push_back({where, "side_force_n", pass.side_force_n, "%.5f",
                         unmoved(limit.side_force_n), SoilLine::Error::kAbsolute});
      }
      lines.push_back({where, "torque_nm", pass.torque_nm, "%.6f", unmoved(limit.torque_nm),
                       SoilLine::Error::kAbsolute});
      lines.push_back({where, "rut_mm", pass.rut_m * kMilli, "%.4f", unmoved(limit.rut_m * kMilli),
                       SoilLine::Error::kRelative});
      lines.push_back({where, "ripple_mm", pass.ripple_m * kMilli, "%.4f"});
      if (i > 0) continue;
      sinkage[0].points.push_back({slip, pass.sinkage_m * kMilli});
      pull[0].points.push_back({slip, pass.drawbar_pull_n});
      sinkage[1].points.push_back({slip, limit.sinkage_m * kMilli});
      pull[1].points.push_back({slip, limit.drawbar_pull_n});
    }
    lines.push_back({text("slip %g", slip), "volume_error",
                     static_cast<double>(result.balance.error()), "%.0f", 0.0});
  }
  bar.clear();
  if (!a.common.charts.empty()) {
    const std::string how = a.common.soil().name + ", normal stress " + a.common.normal_stress;
    chart_wheel(a, "soil_wheel_sinkage.svg", "Sinkage of a wheel: " + how, "sinkage [mm]",
                {sinkage[0], sinkage[1]});
    chart_wheel(a, "soil_wheel_pull.svg", "Drawbar pull of a wheel: " + how, "drawbar pull [N]",
                {pull[0], pull[1]});
  }
  return finish(a.common, "wheel", wheel_words(a), "limit", lines);
}

}  // namespace

void register_soil_wheel_command(CLI::App& soil, Program& program) {
  const auto a = std::make_shared<WheelArguments>();
  CLI::App* command = soil.add_subcommand(
      "wheel",
      "Roll a wheel at imposed slip and compare with the limit of an infinitely fine grid");
  add_soil_options(*command, a->common);
  add_number(*command, "--slip", a->slips, "Slip; several with commas between them", {-1.0, 0.99});
  add_number(*command, "--load", a->test.wheel.load_n, "Load on the wheel [N]", {1e-3, 1e6});
  add_number(*command, "--radius", a->test.wheel.radius_m, "Radius of the wheel [m]", {1e-3, 10.0});
  add_number(*command, "--width", a->test.wheel.width_m, "Width of the wheel [m]", {1e-3, 10.0});
  add_number(*command, "--mass", a->test.mass_kg, "Mass that moves vertically [kg]", {1e-4, 1e4});
  add_number(*command, "--speed", a->test.speed_m_per_s, "Travel speed [m/s]", {1e-4, 10.0});
  add_number(*command, "--duration", a->test.duration_s, "Duration of a pass [s]", {0.1, 3600.0});
  add_number(*command, "--offset", a->test.offset_m,
             "Offset of the wheel's track across the grid [m]", {-1.0, 1.0});
  add_number(*command, "--yaw", a->yaw_deg, "Yaw of the wheel's track against the grid [deg]",
             {-360.0, 360.0});
  add_number(*command, "--passes", a->test.passes, "Number of passes over the same track",
             {1, 100});
  add_number(*command, "--slip-angle", a->slip_angle_deg,
             "Angle of travel to the left of the wheel's plane [deg]", {-80.0, 80.0});
  add_number(*command, "--rim-friction", a->rim_friction_deg,
             "Angle of friction between rim and soil [deg]; 90: rough, soil shears on soil",
             {0.0, 90.0});
  add_number(*command, "--rim-adhesion", a->test.wheel.adhesion_pa,
             "Adhesion of soil to the rim [Pa]", {0.0, 1e7});
  CLI::Option* measured =
      command
          ->add_option("--measured", a->measured,
                       "Compare with measurements: a CSV file (default: Ding et al. 2011)")
          ->type_name("FILE");
  measured->expected(0, 1);
  command->add_option("--case", a->cases, "Use the rows whose case begins with this text")
      ->capture_default_str()
      ->type_name("CASE");
  command->add_option("--charts", a->common.charts, "Output folder for SVG charts")
      ->type_name("FOLDER");
  command->callback([a, measured, &program] {
    program.action = [a, measured] {
      if (measured->count() > 0 && a->measured.empty()) {
        a->measured = (data_folders().data / "soil" / "single_wheel_ding2011.csv").string();
      }
      return run_wheel_command(*a);
    };
  });
}

}  // namespace screed
