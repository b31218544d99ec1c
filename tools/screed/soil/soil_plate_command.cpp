// `screed soil plate`: pressure of a plate beside Bekker's law. `screed soil match`: what soil a
// bed of particles is like.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <numbers>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/random.h"
#include "host_sim/physics/soil/soil_laws.h"
#include "host_sim/render/chart/line_chart.h"
#include "host_sim/soil_validation/check_range.h"
#include "host_sim/soil_validation/plate_press.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/soil/soil_command.h"

namespace screed {
namespace {

struct PlateArguments : SoilArguments {
  PlateTest test;
  double yaw_deg = 0.0;
  double depth_m = 0.02;
  double lift_m = 0.0;
  int offsets = 0;
  uint64_t seed = 1;
};

constexpr double kPlateDepths_m[] = {0.001, 0.002, 0.005, 0.01, 0.015, 0.02};

/// What Chrono's SCM with its default rays adds to Bekker's pressure, percent
/// (docs/studies/soil.md).
std::optional<double> peer_pressure(const PlateArguments& a, double depth_m) {
  const PlateTest& t = a.test;
  if (!a.as_peer() || a.cell_m != 0.005 || t.round || t.length_m != 0.05 || t.width_m != 0.05) {
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
  chart.title = "A plate in " + a.soil().name + ", pressure and depth";
  chart.x_label = "depth [mm]";
  chart.y_label = "pressure [kPa]";
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
  write_chart(a.chart("soil_plate.svg"), chart);
}

SoilReport run_plate(PlateArguments a) {
  a.set(a.test);
  a.test.yaw_rad = a.yaw_deg * kDegree;
  a.test.depths_m = {a.depth_m};
  if (a.lift_m > 0.0) a.test.depths_m.push_back(a.depth_m - a.lift_m);
  const std::vector<PlatePoint> run = press_plate(a.test);
  std::vector<SoilLine> lines;
  std::vector<double> depths;
  for (const double depth : kPlateDepths_m) {
    if (depth < a.depth_m - 1e-9) depths.push_back(depth);
  }
  depths.push_back(a.depth_m);
  for (const double depth : depths) {
    const PlatePoint& point = at_depth(run, depth);
    lines.push_back({text("depth %g mm", point.depth_m * kMilli), "pressure_pa", point.pressure_pa,
                     "%.1f", point.bekker_pa, SoilLine::Error::kRelative, peer_pressure(a, depth)});
  }
  const double b = a.test.round ? 0.5 * a.test.length_m : std::min(a.test.length_m, a.test.width_m);
  lines.push_back({text("depth %g mm", a.depth_m * kMilli), "b_mm",
                   at_depth(run, a.depth_m).b_m * kMilli, "%.3f", b * kMilli,
                   SoilLine::Error::kRelative});
  if (a.lift_m > 0.0) {
    const PlatePoint& end = run.back();
    const double deepest = bekker_pressure(a.test, a.depth_m);
    lines.push_back({text("lifted %g mm", a.lift_m * kMilli), "pressure_pa", end.pressure_pa,
                     "%.1f", std::max(0.0, deepest - a.test.soil.elastic_pa_per_m * a.lift_m),
                     SoilLine::Error::kRelative});
  }
  if (a.offsets > 0) {
    // Greatest error over places between the nodes, and over these and any yaw.
    WorldRandom random(a.seed, "plate");
    ProgressBar bar(std::cerr);
    for (const bool turned : {false, true}) {
      double worst = 0.0;
      double worst_b = 0.0;
      for (int i = 0; i < a.offsets; ++i) {
        bar.show_share((turned ? 0.5 : 0.0) + 0.5 * i / a.offsets, "pressing a plate");
        PlateTest test = a.test;
        test.offset_x_m = a.cell_m * random.uniform();
        test.offset_y_m = a.cell_m * random.uniform();
        if (turned) test.yaw_rad = random.uniform(0.0, std::numbers::pi);
        for (const PlatePoint& point : press_plate(test)) {
          if (point.depth_m < 1e-3 || point.depth_m > a.depth_m) continue;
          worst = std::max(worst, std::abs(point.pressure_pa / point.bekker_pa - 1.0));
          worst_b = std::max(worst_b, std::abs(point.b_m / b - 1.0));
          if (point.depth_m >= a.depth_m) break;
        }
      }
      const std::string where =
          std::to_string(a.offsets) + (turned ? " positions and yaws" : " positions");
      lines.push_back({where, "worst_pressure_percent", 100.0 * worst, "%.3f"});
      lines.push_back({where, "worst_b_percent", 100.0 * worst_b, "%.3f"});
    }
    bar.clear();
  }
  if (!a.charts.empty()) chart_plate(a, run);
  const std::string shape = a.test.round ? text("disc of %g mm", a.test.length_m * kMilli)
                                         : text("plate of %g", a.test.length_m * kMilli) +
                                               text(" x %g mm", a.test.width_m * kMilli);
  return {"plate", a.test.soil.name + ", " + shape + text(", grid %g mm", a.cell_m * kMilli),
          "Bekker", lines};
}

void add_plate(Command& soil, Program& program) {
  const auto a = std::make_shared<PlateArguments>();
  Command* command =
      add_soil_test(soil, program, "plate", "Press a plate into soil and compare with Bekker's law",
                    a, run_plate, {.step_s = {1e-5, 0.1}});
  command->add_flag("--round", a->test.round, "Press a disc; --length is its diameter");
  add_number(*command, "--length", a->test.length_m, "Length of the plate [m]", {0.005, 1.0});
  add_number(*command, "--width", a->test.width_m, "Width of the plate [m]", {0.005, 1.0});
  add_number(*command, "--depth", a->depth_m, "Depth to press to [m]", {0.0001, 0.25});
  add_number(*command, "--lift", a->lift_m, "Distance to lift the plate afterwards [m]",
             {0.0, 0.35});
  add_number(*command, "--speed", a->test.speed_m_per_s, "Pressing speed [m/s]", {0.001, 10.0});
  add_number(*command, "--offset-x", a->test.offset_x_m,
             "Offset of the plate against the grid in x [m]", {-1.0, 1.0});
  add_number(*command, "--offset-y", a->test.offset_y_m,
             "Offset of the plate against the grid in y [m]", {-1.0, 1.0});
  add_number(*command, "--yaw", a->yaw_deg, "Yaw of the plate [deg]", {-360.0, 360.0});
  add_number(*command, "--offsets", a->offsets,
             "Number of random positions and yaws to find the worst error over", {0, 10000});
  add_number(*command, "--seed", a->seed, "Seed of the random positions", kSeedRange);
  command->add_option("--charts", a->charts, "Output folder for soil_plate.svg")
      ->type_name("FOLDER");
}

// ---- match

struct MatchArguments : SoilArguments {
  ParticlePlateTest test;
};

SoilReport run_match(MatchArguments a) {
  const SoilParameters soil = a.soil();
  std::vector<SoilLine> lines;
  TaskBar bar(false);
  for (const ParticlePlatePoint& point : press_particles(a.test, bar.progress())) {
    const std::string where = text("plate, %g kPa", point.pressure_pa / kMilli);
    const double depth =
        bekker_depth_m(soil, std::min(a.test.length_m, a.test.width_m), point.pressure_pa);
    lines.push_back({where, "depth_mm", point.depth_m() * kMilli, "%.2f",
                     std::max(depth, point.pressure_pa / soil.elastic_pa_per_m) * kMilli,
                     SoilLine::Error::kRelative});
    lines.push_back({where, "rut_mm", point.rut_m * kMilli, "%.2f",
                     std::max(0.0, depth - point.pressure_pa / soil.elastic_pa_per_m) * kMilli,
                     SoilLine::Error::kNone});
    lines.push_back({where, "raised_cm3", point.raised_m3 * 1e6, "%.1f"});
    lines.push_back({where, "stiffness_pa_per_m", point.stiffness_pa_per_m, "%.3g",
                     soil.elastic_pa_per_m, SoilLine::Error::kNone});
  }
  const ParticleDrag drag = drag_over_particles(a.test, bar.progress());
  bar.clear();
  constexpr double kDegrees = 57.29577951308232;
  lines.push_back({"block", "friction_deg", portable::atan(drag.friction) * kDegrees, "%.1f",
                   soil.friction_deg, SoilLine::Error::kNone});
  lines.push_back({"block", "shear_modulus_mm", drag.shear_displacement_m * kMilli, "%.2f",
                   soil.shear_modulus_m * kMilli, SoilLine::Error::kNone});
  return {"match",
          text("particles of radius %g mm beside ", a.test.particle.radius_m * kMilli) + soil.name,
          soil.name, lines};
}

void add_match(Command& soil, Program& program) {
  const auto a = std::make_shared<MatchArguments>();
  a->preset = "gravel";
  Command* command = add_soil_test(
      soil, program, "match",
      "Identify the soil parameters of a particle bed: press a plate, drag a block", a, run_match);
  a->test.particle.radius_m = 0.0075;
  add_particle_options(*command, a->test.particle, a->test.depth_m, a->test.seed);
  add_number(*command, "--length", a->test.length_m, "Length of plate and block [m]", {0.02, 0.3});
  add_number(*command, "--width", a->test.width_m, "Width of plate and block [m]", {0.02, 0.3});
  add_number(*command, "--load", a->test.load_pa, "Pressure below the block [Pa]", {100.0, 1e5});
  add_number(*command, "--beds", a->test.beds, "Number of particle beds to average over", {1, 64});
}

}  // namespace

void register_soil_plate_command(Command& soil, Program& program) {
  add_match(soil, program);
  add_plate(soil, program);
}

}  // namespace screed
