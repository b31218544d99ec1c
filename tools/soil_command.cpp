// `screed soil`: options, runs of host_sim/soil_lab, and what is set beside their results.
#include "tools/soil_command.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "host_sim/picture/line_chart.h"
#include "host_sim/soil_lab/check_range.h"
#include "host_sim/soil_lab/plate_press.h"
#include "host_sim/soil_lab/repose_pile.h"
#include "host_sim/soil_lab/soil_robot.h"
#include "host_sim/soil_lab/wheel_testbed.h"
#include "paths.h"

namespace screed {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMilli = 1e3;

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

/// One line of the result: a figure beside what it should be and what a peer's engine gives.
struct Line {
  std::string where;  ///< "slip 0.2", "depth 5 mm"
  std::string name;   ///< for programs, unit included
  double value;
  const char* format;
  std::optional<double> limit = std::nullopt;  ///< closed form, limit or measurement
  enum class Error { kRelative, kAbsolute, kNone } error = Error::kNone;
  std::optional<double> peer = std::nullopt;
};

std::string error_of(const Line& line) {
  if (!line.limit || line.error == Line::Error::kNone) return "";
  if (line.error == Line::Error::kAbsolute) return text("%+.5f", line.value - *line.limit);
  return *line.limit == 0.0 ? "" : text("%+.3f %%", 100.0 * (line.value / *line.limit - 1.0));
}

void print_table(const std::string& heading, const char* limit_name,
                 const std::vector<Line>& lines) {
  std::cout << heading << "\n\n";
  std::vector<std::vector<std::string>> rows = {{"", "", "result", limit_name, "error", "Chrono"}};
  for (const Line& line : lines) {
    rows.push_back({line.where, line.name, text(line.format, line.value),
                    line.limit ? text(line.format, *line.limit) : "", error_of(line),
                    line.peer ? text(line.format, *line.peer) : ""});
  }
  // Columns that say nothing stay away.
  std::vector<size_t> widths(rows[0].size(), 0);
  for (size_t column = 0; column < widths.size(); ++column) {
    bool any = false;
    for (size_t i = 0; i < rows.size(); ++i) {
      any = any || (i > 0 && !rows[i][column].empty());
      widths[column] = std::max(widths[column], rows[i][column].size());
    }
    if (!any) widths[column] = 0;
  }
  for (const std::vector<std::string>& row : rows) {
    std::string out;
    for (size_t column = 0; column < row.size(); ++column) {
      if (widths[column] == 0) continue;
      const std::string fill(widths[column] - row[column].size() + 2, ' ');
      out += column < 2 ? row[column] + fill : fill + row[column];
    }
    out.erase(out.find_last_not_of(' ') + 1);
    std::cout << out << "\n";
  }
}

nlohmann::json to_json(const std::vector<Line>& lines) {
  nlohmann::json all = nlohmann::json::array();
  for (const Line& line : lines) {
    nlohmann::json one = {{"where", line.where}, {"name", line.name}, {"value", line.value}};
    if (line.limit) one["limit"] = *line.limit;
    if (line.peer) one["chrono"] = *line.peer;
    all.push_back(one);
  }
  return all;
}

/// Options that every test has.
struct Common {
  std::string preset = "viper";
  SoilParameters custom;  // values of the options that were given
  std::vector<std::pair<CLI::Option*, double SoilParameters::*>> given;
  std::string normal_stress = "radial";
  bool bulldozing = false;
  bool avalanches = false;
  double sample_spacing_m = SoilOptions{}.sample_spacing_m;
  double cell_m = 0.005;
  double step_s = 1e-3;
  std::string charts;
  bool json = false;

  SoilParameters soil() const {
    SoilParameters soil = soil_preset(preset);
    for (const auto& [option, member] : given) {
      if (option->count() == 0) continue;
      soil.*member = custom.*member;
      soil.name = preset + ", changed";
    }
    check_soil(soil);
    return soil;
  }
  SoilOptions options() const {
    if (normal_stress != "radial" && normal_stress != "vertical") {
      throw InputError("soil: normal-stress = " + normal_stress +
                       "; allowed is radial or vertical");
    }
    check_range("soil", "sample-spacing", sample_spacing_m, 1e-4, 0.1);
    SoilOptions options;
    options.normal_stress =
        normal_stress == "radial" ? NormalStress::kRadial : NormalStress::kVertical;
    options.bulldozing = bulldozing;
    options.avalanches = avalanches;
    options.sample_spacing_m = sample_spacing_m;
    return options;
  }
  /// Empty: no charts. The folder is made.
  std::filesystem::path chart(const char* name) const {
    std::error_code error;
    std::filesystem::create_directories(charts, error);
    if (error) throw RunError(charts + ": the folder cannot be made");
    return std::filesystem::path(charts) / name;
  }
  /// Whether the soil and its handling are those of the peer's figures.
  bool as_peer() const {
    if (preset != "viper" || step_s != 1e-3) return false;
    return std::none_of(given.begin(), given.end(),
                        [](const auto& option) { return option.first->count() > 0; });
  }
};

void add_common(CLI::App& command, Common& common) {
  std::string names;
  for (const SoilParameters& preset : soil_presets()) {
    names += (names.empty() ? "" : ", ") + preset.name;
  }
  command.add_option("--soil", common.preset, names);
  const auto parameter = [&](const char* name, double SoilParameters::*member, const char* what) {
    common.given.emplace_back(command.add_option(name, common.custom.*member, what), member);
  };
  parameter("--k-phi", &SoilParameters::k_phi, "N/m^(n+2); this and the next override the soil's");
  parameter("--k-c", &SoilParameters::k_c, "N/m^(n+1)");
  parameter("--exponent", &SoilParameters::exponent, "n of Bekker's law");
  parameter("--cohesion", &SoilParameters::cohesion_pa, "Pa");
  parameter("--friction", &SoilParameters::friction_deg, "angle of internal friction, degrees");
  parameter("--shear-modulus", &SoilParameters::shear_modulus_m, "K of Janosi and Hanamoto, m");
  parameter("--elastic", &SoilParameters::elastic_pa_per_m, "E of unloading, Pa/m");
  parameter("--damping", &SoilParameters::damping_pa_s_per_m, "R, Pa s/m");
  parameter("--repose", &SoilParameters::repose_deg, "angle of repose, degrees");
  parameter("--compaction", &SoilParameters::compaction, "share of the sunk volume, 0..1");
  parameter("--drag-depth", &SoilParameters::drag_depth_m,
            "layer that moves with a slipping rim, m");
  parameter("--slip-sinkage", &SoilParameters::slip_sinkage, "n grows by this times the slip");
  command.add_option("--normal-stress", common.normal_stress, "radial, vertical");
  command.add_flag("--bulldozing,!--no-bulldozing", common.bulldozing,
                   "sunk material is pushed aside; else compacted");
  command.add_flag("--avalanches,!--no-avalanches", common.avalanches, "steep slopes slide");
  command.add_option("--sample-spacing", common.sample_spacing_m, "of places inside a cell, m");
  command.add_option("--cell", common.cell_m, "of the grid, m");
  command.add_option("--step", common.step_s, "s");
  command.add_flag("--json", common.json, "print JSON");
}

nlohmann::json soil_json(const Common& common) {
  const SoilParameters s = common.soil();
  return {{"name", s.name},
          {"k_phi", s.k_phi},
          {"k_c", s.k_c},
          {"exponent", s.exponent},
          {"cohesion_pa", s.cohesion_pa},
          {"friction_deg", s.friction_deg},
          {"shear_modulus_m", s.shear_modulus_m},
          {"elastic_pa_per_m", s.elastic_pa_per_m},
          {"damping_pa_s_per_m", s.damping_pa_s_per_m},
          {"repose_deg", s.repose_deg},
          {"compaction", s.compaction},
          {"drag_depth_m", s.drag_depth_m},
          {"slip_sinkage", s.slip_sinkage},
          {"normal_stress", common.normal_stress},
          {"bulldozing", common.bulldozing},
          {"avalanches", common.avalanches},
          {"cell_m", common.cell_m},
          {"step_s", common.step_s}};
}

int finish(const Common& common, const char* test, const std::string& heading,
           const char* limit_name, const std::vector<Line>& lines) {
  if (common.json) {
    const nlohmann::json out = {
        {"test", test}, {"soil", soil_json(common)}, {"results", to_json(lines)}};
    std::cout << out.dump(2) << "\n";
  } else {
    print_table(heading, limit_name, lines);
  }
  return 0;
}

// ---- plate ------------------------------------------------------------------------------------

struct PlateArguments {
  Common common;
  PlateTest test;
  double yaw_deg = 0.0;
  double depth_m = 0.02;
  double lift_m = 0.0;
  int offsets = 0;
  uint64_t seed = 1;
};

constexpr double kPlateDepths_m[] = {0.001, 0.002, 0.005, 0.01, 0.015, 0.02};

/// What Chrono's SCM with its default rays adds to Bekker's pressure, percent (docs/soil.md).
std::optional<double> peer_pressure(const PlateArguments& a, double depth_m) {
  const PlateTest& t = a.test;
  if (!a.common.as_peer() || a.common.cell_m != 0.005 || t.round || t.length_m != 0.05 ||
      t.width_m != 0.05) {
    return std::nullopt;
  }
  constexpr std::pair<double, double> kExcess[] = {
      {0.001, 373.0}, {0.005, 145.0}, {0.01, 118.0}, {0.02, 105.0}};
  for (const auto& [depth, percent] : kExcess) {
    if (std::abs(depth - depth_m) < 1e-9) {
      return bekker_pressure(t, depth) * (1.0 + 0.01 * percent);
    }
  }
  return std::nullopt;
}

void chart_plate(const PlateArguments& a, const std::vector<PlatePoint>& run) {
  Chart chart;
  chart.title = "A plate in " + a.common.soil().name + ", pressure and depth";
  chart.x_label = "depth, mm";
  chart.y_label = "pressure, kPa";
  ChartSeries engine{.label = "Screed", .points = {}, .markers = false};
  ChartSeries closed{.label = "Bekker", .points = {}, .markers = true};
  ChartSeries peer{.label = "Chrono, default rays", .points = {}, .markers = true};
  for (size_t i = 0; i < run.size(); i += std::max<size_t>(1, run.size() / 200)) {
    engine.points.push_back({run[i].depth_m * kMilli, run[i].pressure_pa / kMilli});
  }
  for (const double depth : kPlateDepths_m) {
    if (depth > a.depth_m + 1e-9) break;
    closed.points.push_back({depth * kMilli, bekker_pressure(a.test, depth) / kMilli});
    if (const auto p = peer_pressure(a, depth))
      peer.points.push_back({depth * kMilli, *p / kMilli});
  }
  chart.series = {engine, closed};
  if (!peer.points.empty()) chart.series.push_back(peer);
  write_chart(a.common.chart("soil_plate.svg"), chart);
}

int run_plate(PlateArguments a) {
  a.test.soil = a.common.soil();
  a.test.options = a.common.options();
  a.test.cell_m = a.common.cell_m;
  a.test.step_s = a.common.step_s;
  a.test.yaw_rad = a.yaw_deg * kDegree;
  a.test.way_m = {a.depth_m};
  if (a.lift_m > 0.0) a.test.way_m.push_back(a.depth_m - a.lift_m);
  check_range("plate", "offsets", a.offsets, 0, 10000);
  const std::vector<PlatePoint> run = press_plate(a.test);
  std::vector<Line> lines;
  std::vector<double> depths;
  for (const double depth : kPlateDepths_m) {
    if (depth < a.depth_m - 1e-9) depths.push_back(depth);
  }
  depths.push_back(a.depth_m);
  for (const double depth : depths) {
    const PlatePoint& point = at_depth(run, depth);
    lines.push_back({text("depth %g mm", point.depth_m * kMilli), "pressure_pa", point.pressure_pa,
                     "%.1f", point.bekker_pa, Line::Error::kRelative, peer_pressure(a, depth)});
  }
  const double b = a.test.round ? 0.5 * a.test.length_m : std::min(a.test.length_m, a.test.width_m);
  lines.push_back({text("depth %g mm", a.depth_m * kMilli), "b_mm",
                   at_depth(run, a.depth_m).b_m * kMilli, "%.3f", b * kMilli,
                   Line::Error::kRelative});
  if (a.lift_m > 0.0) {
    const PlatePoint& end = run.back();
    const double deepest = bekker_pressure(a.test, a.depth_m);
    lines.push_back({text("lifted %g mm", a.lift_m * kMilli), "pressure_pa", end.pressure_pa,
                     "%.1f", std::max(0.0, deepest - a.test.soil.elastic_pa_per_m * a.lift_m),
                     Line::Error::kRelative});
  }
  if (a.offsets > 0) {
    // Greatest error over places between the nodes, and over these and any yaw.
    WorldRandom random(a.seed, "plate");
    for (const bool turned : {false, true}) {
      double worst = 0.0;
      double worst_b = 0.0;
      for (int i = 0; i < a.offsets; ++i) {
        PlateTest test = a.test;
        test.offset_x_m = a.common.cell_m * random.uniform();
        test.offset_y_m = a.common.cell_m * random.uniform();
        if (turned) test.yaw_rad = random.uniform(0.0, std::numbers::pi);
        for (const PlatePoint& point : press_plate(test)) {
          if (point.depth_m < 1e-3 || point.depth_m > a.depth_m) continue;
          worst = std::max(worst, std::abs(point.pressure_pa / point.bekker_pa - 1.0));
          worst_b = std::max(worst_b, std::abs(point.b_m / b - 1.0));
          if (point.depth_m >= a.depth_m) break;
        }
      }
      const std::string where =
          std::to_string(a.offsets) + (turned ? " places and yaws" : " places");
      lines.push_back({where, "worst_pressure_percent", 100.0 * worst, "%.3f"});
      lines.push_back({where, "worst_b_percent", 100.0 * worst_b, "%.3f"});
    }
  }
  if (!a.common.charts.empty()) chart_plate(a, run);
  const std::string shape = a.test.round ? text("disc of %g mm", a.test.length_m * kMilli)
                                         : text("plate of %g", a.test.length_m * kMilli) +
                                               text(" x %g mm", a.test.width_m * kMilli);
  return finish(a.common, "plate",
                a.test.soil.name + ", " + shape + text(", grid %g mm", a.common.cell_m * kMilli),
                "Bekker", lines);
}

// ---- wheel ------------------------------------------------------------------------------------

struct WheelArguments {
  Common common;
  WheelTest test;
  double yaw_deg = 0.0;
  std::vector<double> slips = {0.0, 0.2, 0.4};
  std::string measured;
  std::string cases = "ding2011_smooth";
  bool fit = false;
};

/// Chrono's SCM (exact rays) for Ding's wheel: slip, drawbar pull N, sinkage m (docs/soil.md).
struct PeerWheel {
  double slip;
  double drawbar_pull_n;
};
constexpr PeerWheel kPeerDing[] = {{0.1, 11.2}, {0.2, 23.9}, {0.3, 33.8}, {0.4, 41.2}, {0.6, 49.2}};

void chart_wheel(const WheelArguments& a, const char* file, const std::string& title,
                 const char* y_label, const std::vector<ChartSeries>& series) {
  Chart chart;
  chart.title = title;
  chart.x_label = "slip";
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
  const std::vector<MeasuredWheel> rows = read_measured_wheels(a.measured, a.cases);
  const NormalStress stress = a.test.options.normal_stress;
  if (a.fit) a.test.soil.slip_sinkage = fit_slip_sinkage(rows, a.test.soil, stress, 0.2, 0.6);
  std::vector<Line> lines;
  ChartSeries sinkage[3] = {{"Screed", {}, true}, {"limit", {}, false}, {"measured", {}, true}};
  ChartSeries pull[4] = {
      {"Screed", {}, true}, {"limit", {}, false}, {"measured", {}, true}, {"Chrono", {}, true}};
  if (a.fit) {
    lines.push_back({"fitted", "slip_sinkage", a.test.soil.slip_sinkage, "%.2f"});
  }
  for (const MeasuredWheel& row : rows) {
    a.test.wheel = row.wheel;
    const WheelPass pass = run_wheel(a.test).passes[0];
    const WheelReaction limit = wheel_limit(row.wheel, a.test.soil, stress);
    const std::string where = text("slip %g", row.wheel.slip);
    std::optional<double> peer;
    for (const PeerWheel& known : kPeerDing) {
      if (a.cases == "ding2011_smooth" && std::abs(known.slip - row.wheel.slip) < 1e-9) {
        peer = known.drawbar_pull_n;
        pull[3].points.push_back({known.slip, *peer});
      }
    }
    lines.push_back({where, "sinkage_mm", pass.sinkage_m * kMilli, "%.2f", row.sinkage_m * kMilli,
                     Line::Error::kRelative, peer ? std::optional(8.65) : std::nullopt});
    lines.push_back({where, "drawbar_pull_n", pass.drawbar_pull_n, "%.1f", row.drawbar_pull_n,
                     Line::Error::kRelative, peer});
    lines.push_back(
        {where, "torque_nm", pass.torque_nm, "%.2f", row.torque_nm, Line::Error::kRelative});
    sinkage[0].points.push_back({row.wheel.slip, pass.sinkage_m * kMilli});
    sinkage[1].points.push_back({row.wheel.slip, limit.sinkage_m * kMilli});
    sinkage[2].points.push_back({row.wheel.slip, row.sinkage_m * kMilli});
    pull[0].points.push_back({row.wheel.slip, pass.drawbar_pull_n});
    pull[1].points.push_back({row.wheel.slip, limit.drawbar_pull_n});
    pull[2].points.push_back({row.wheel.slip, row.drawbar_pull_n});
  }
  if (!a.common.charts.empty()) {
    chart_wheel(a, "soil_measured_sinkage.svg", "Sinkage of a wheel, measured and simulated",
                "sinkage, mm", {sinkage[0], sinkage[1], sinkage[2]});
    std::vector<ChartSeries> pulls = {pull[0], pull[1], pull[2]};
    if (!pull[3].points.empty()) pulls.push_back(pull[3]);
    chart_wheel(a, "soil_measured_pull.svg", "Drawbar pull of a wheel, measured and simulated",
                "drawbar pull, N", pulls);
  }
  return finish(a.common, "wheel", wheel_words(a), "measured", lines);
}

int run_wheel_command(WheelArguments a) {
  a.test.soil = a.common.soil();
  a.test.options = a.common.options();
  a.test.cell_m = a.common.cell_m;
  a.test.step_s = a.common.step_s;
  a.test.yaw_rad = a.yaw_deg * kDegree;
  if (!a.measured.empty()) return run_measured(a);
  std::vector<Line> lines;
  ChartSeries sinkage[2] = {{"Screed", {}, true}, {"limit", {}, false}};
  ChartSeries pull[2] = {{"Screed", {}, true}, {"limit", {}, false}};
  for (const double slip : a.slips) {
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
                       unmoved(limit.sinkage_m * kMilli), Line::Error::kRelative});
      lines.push_back({where, "drawbar_pull_n", pass.drawbar_pull_n, "%.5f",
                       unmoved(limit.drawbar_pull_n), Line::Error::kAbsolute});
      lines.push_back({where, "torque_nm", pass.torque_nm, "%.6f", unmoved(limit.torque_nm),
                       Line::Error::kAbsolute});
      lines.push_back({where, "rut_mm", pass.rut_m * kMilli, "%.4f", unmoved(limit.rut_m * kMilli),
                       Line::Error::kRelative});
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
  if (!a.common.charts.empty()) {
    const std::string how = a.common.soil().name + ", normal stress " + a.common.normal_stress;
    chart_wheel(a, "soil_wheel_sinkage.svg", "Sinkage of a wheel: " + how, "sinkage, mm",
                {sinkage[0], sinkage[1]});
    chart_wheel(a, "soil_wheel_pull.svg", "Drawbar pull of a wheel: " + how, "drawbar pull, N",
                {pull[0], pull[1]});
  }
  return finish(a.common, "wheel", wheel_words(a), "limit", lines);
}

// ---- robot ------------------------------------------------------------------------------------

struct RobotArguments {
  Common common;
  double size_m = 2.0;
  bool wrap = false;
  double duration_s = 5.0;
  double left_m_per_s = 0.2;
  double right_m_per_s = 0.2;
  double relief_m = 0.0;
  double x_m = -0.5;
  double y_m = 0.0;
};

/// Milliseconds a step of Chrono's SCM with its default rays (docs/soil.md).
std::optional<double> peer_step_us(const RobotArguments& a) {
  if (!a.common.as_peer() || a.size_m != 2.0) return std::nullopt;
  constexpr struct {
    double cell_m;
    double plain_us;
    double bulldozing_us;
  } kPeer[] = {{0.01, 93.5, 366.0}, {0.005, 237.0, 699.0}, {0.0025, 926.0, 1770.0}};
  for (const auto& row : kPeer) {
    if (std::abs(row.cell_m - a.common.cell_m) < 1e-9) {
      return a.common.bulldozing ? row.bulldozing_us : row.plain_us;
    }
  }
  return std::nullopt;
}

int run_robot(const RobotArguments& a) {
  check_range("robot", "cell", a.common.cell_m, 0.0005, 0.1);
  check_range("robot", "size", a.size_m, 0.5, 20.0);
  check_range("robot", "duration", a.duration_s, 0.01, 1e5);
  check_range("robot", "step", a.common.step_s, 1e-5, 0.02);
  check_range("robot", "relief", a.relief_m, 0.0, 0.1);
  const int nodes = static_cast<int>(std::lround(a.size_m / a.common.cell_m)) + (a.wrap ? 0 : 1);
  const double period = nodes * a.common.cell_m;
  const auto waves = [&](double x, double y) {
    const double k = 2.0 * std::numbers::pi / period;
    return 0.5 * a.relief_m * (std::sin(2.0 * k * x) * std::cos(3.0 * k * y));
  };
  const SoilParameters soil = a.common.soil();
  SoilBed bed(HeightField::from_function(nodes, nodes, a.common.cell_m, a.wrap, waves), soil,
              a.common.options());
  SoilRobot robot(bed, {}, a.x_m, a.y_m);
  const double dt = a.common.step_s;
  const auto steps = static_cast<int64_t>(std::llround(a.duration_s / dt));
  const int64_t untimed = steps / 5;
  std::clock_t begin = std::clock();
  const double level = robot.position().z();
  double load = 0.0;
  double way = 0.0;
  for (int64_t i = 0; i < steps; ++i) {
    if (i == untimed) begin = std::clock();
    robot.step(a.left_m_per_s, a.right_m_per_s, dt);
    if (i >= untimed) load += robot.load_n();
    way += dt * robot.velocity().head<2>().norm();
  }
  const auto timed = static_cast<double>(steps - untimed);
  const double us = static_cast<double>(std::clock() - begin) * 1e6 / CLOCKS_PER_SEC / timed;
  const Eigen::Vector3d place = robot.position();
  std::vector<Line> lines = {
      {"", "step_us", us, "%.2f", std::nullopt, Line::Error::kNone, peer_step_us(a)},
      {"", "mean_load_n", load / timed, "%.4f"},
      {"", "lower_by_mm", (level - place.z()) * kMilli, "%.3f"},
      {"", "way_m", way, "%.4f"},
      {"", "away_m", std::hypot(place.x() - a.x_m, place.y() - a.y_m), "%.4f"},
      {"", "speed_m_per_s", robot.velocity().dot(robot.rotation().col(0)), "%.4f"},
      {"", "volume_error", static_cast<double>(bed.balance().error()), "%.0f", 0.0},
      {"", "volume_in_hand", static_cast<double>(bed.balance().in_hand), "%.0f"},
      {"", "compacted_cm3",
       static_cast<double>(bed.balance().compacted) * kHeightUnit_m * a.common.cell_m *
           a.common.cell_m * 1e6,
       "%.3f"},
  };
  const std::string hash = surface_hash(bed.surface());
  if (a.common.avalanches) {
    bed.settle();
    lines.push_back({"settled", "excess_units", repose_excess_units(bed.surface(), soil.repose_deg),
                     "%.3f", 1.0});
    lines.push_back(
        {"settled", "volume_error", static_cast<double>(bed.balance().error()), "%.0f", 0.0});
  }
  if (a.common.json) {
    const nlohmann::json out = {{"test", "robot"},
                                {"soil", soil_json(a.common)},
                                {"steps", steps},
                                {"heights_hash", hash},
                                {"results", to_json(lines)}};
    std::cout << out.dump(2) << "\n";
    return 0;
  }
  print_table(soil.name + text(", robot on a bed of %g m", a.size_m) +
                  text(", grid %g mm", a.common.cell_m * kMilli) +
                  text(", %g s in steps", a.duration_s) + text(" of %g ms", dt * kMilli),
              "must be", lines);
  std::cout << "\nheights " << hash << "\n";
  return 0;
}

// ---- repose -----------------------------------------------------------------------------------

struct ReposeArguments {
  Common common;
  ReposeTest test;
};

int run_repose(ReposeArguments a) {
  a.test.soil = a.common.soil();
  a.test.cell_m = a.common.cell_m;
  const ReposeResult result = collapse(a.test);
  const double repose = a.test.soil.repose_deg;
  return finish(a.common, "repose",
                a.test.soil.name + text(", a tower of %g mm", a.test.height_m * kMilli) +
                    text(", grid %g mm", a.common.cell_m * kMilli),
                "must be",
                {{"along the axes", "slope_deg", result.slope_axis_deg, "%.2f", repose,
                  Line::Error::kRelative},
                 {"along diagonals", "slope_deg", result.slope_diagonal_deg, "%.2f", repose,
                  Line::Error::kRelative},
                 {"steepest pair", "excess_units", result.excess_units, "%.3f", 1.0},
                 {"", "volume_error", static_cast<double>(result.volume_error), "%.0f", 0.0},
                 {"", "moves", static_cast<double>(result.moves), "%.0f"}});
}

// ---- options ----------------------------------------------------------------------------------

void add_plate(CLI::App& soil, std::function<int()>& action) {
  const auto a = std::make_shared<PlateArguments>();
  CLI::App* command = soil.add_subcommand("plate", "Press a plate in, beside Bekker's law");
  add_common(*command, a->common);
  command->add_flag("--round", a->test.round, "a disc; --length is its diameter");
  command->add_option("--length", a->test.length_m, "m");
  command->add_option("--width", a->test.width_m, "m");
  command->add_option("--depth", a->depth_m, "m");
  command->add_option("--lift", a->lift_m, "by so much afterwards, m");
  command->add_option("--speed", a->test.speed_m_per_s, "m/s");
  command->add_option("--offset-x", a->test.offset_x_m, "of the plate against the grid, m");
  command->add_option("--offset-y", a->test.offset_y_m, "m");
  command->add_option("--yaw", a->yaw_deg, "degrees");
  command->add_option("--offsets", a->offsets, "worst error over so many random places and yaws");
  command->add_option("--seed", a->seed, "of these");
  command->add_option("--charts", a->common.charts, "folder for soil_plate.svg");
  command->callback([a, &action] { action = [a] { return run_plate(*a); }; });
}

void add_wheel(CLI::App& soil, std::function<int()>& action) {
  const auto a = std::make_shared<WheelArguments>();
  CLI::App* command = soil.add_subcommand(
      "wheel", "Roll a wheel at imposed slip, beside the limit of an infinitely fine grid");
  add_common(*command, a->common);
  command->add_option("--slip", a->slips, "one or several, -1..0.99")->delimiter(',');
  command->add_option("--load", a->test.wheel.load_n, "N");
  command->add_option("--radius", a->test.wheel.radius_m, "m");
  command->add_option("--width", a->test.wheel.width_m, "m");
  command->add_option("--mass", a->test.mass_kg, "that moves up and down, kg");
  command->add_option("--speed", a->test.speed_m_per_s, "m/s");
  command->add_option("--duration", a->test.duration_s, "of a pass, s");
  command->add_option("--offset", a->test.offset_m, "of the track against the grid, m");
  command->add_option("--yaw", a->yaw_deg, "of the track, degrees");
  command->add_option("--passes", a->test.passes, "over the same track");
  CLI::Option* measured =
      command->add_option("--measured", a->measured,
                          "beside measurements: a CSV file, by default Ding's wheel of 2011");
  measured->expected(0, 1)->default_str(std::string(kDataFolder) +
                                        "/soil/single_wheel_ding2011.csv");
  command->add_option("--case", a->cases, "rows whose case_id begins so");
  command->add_flag("--fit", a->fit, "fit --slip-sinkage to the measured sinkage first");
  command->add_option("--charts", a->common.charts, "folder for SVG charts");
  command->callback([a, measured, &action] {
    action = [a, measured] {
      if (measured->count() > 0 && a->measured.empty()) {
        a->measured = std::string(kDataFolder) + "/soil/single_wheel_ding2011.csv";
      }
      return run_wheel_command(*a);
    };
  });
}

void add_robot(CLI::App& soil, std::function<int()>& action) {
  const auto a = std::make_shared<RobotArguments>();
  CLI::App* command =
      soil.add_subcommand("robot", "Drive a four-wheeled body: CPU time a step, volume balance");
  add_common(*command, a->common);
  command->add_option("--size", a->size_m, "of the bed's side, m");
  command->add_flag("--wrap", a->wrap, "the bed continues at its other side");
  command->add_option("--relief", a->relief_m, "of waves on the bed, m");
  command->add_option("--duration", a->duration_s, "s; the first fifth is not timed");
  command->add_option("--left", a->left_m_per_s, "rim speed of the left wheels, m/s");
  command->add_option("--right", a->right_m_per_s, "rim speed of the right wheels, m/s");
  command->add_option("--x", a->x_m, "start, m");
  command->add_option("--y", a->y_m, "start, m");
  command->callback([a, &action] { action = [a] { return run_robot(*a); }; });
}

void add_repose(CLI::App& soil, std::function<int()>& action) {
  const auto a = std::make_shared<ReposeArguments>();
  CLI::App* command = soil.add_subcommand("repose", "Let a tower collapse to its angle of repose");
  add_common(*command, a->common);
  command->add_option("--size", a->test.size_m, "of the bed's side, m");
  command->add_option("--radius", a->test.radius_m, "of the tower, m");
  command->add_option("--height", a->test.height_m, "of the tower, m");
  command->add_option("--tap", a->test.tap_m, "a plate taps the tower first, m; 0: untouched");
  command->add_option("--x", a->test.centre_x_m, "of its middle, m");
  command->add_option("--y", a->test.centre_y_m, "m");
  command->add_flag("--wrap", a->test.wrap, "the bed continues at its other side");
  command->callback([a, &action] { action = [a] { return run_repose(*a); }; });
}

}  // namespace

void register_soil_command(CLI::App& root, std::function<int()>& action) {
  CLI::App* command = root.add_subcommand("soil", "Reference tests of the deformable soil");
  command->require_subcommand(1);
  add_plate(*command, action);
  add_wheel(*command, action);
  add_robot(*command, action);
  add_repose(*command, action);
}

}  // namespace screed
