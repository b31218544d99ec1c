// `screed soil repose`: a tower collapses to its angle of repose. `screed soil robot`: CPU time a
// step, volume balance, slopes.

#include <cmath>
#include <ctime>
#include <iostream>
#include <memory>
#include <numbers>

#include "host_sim/core/elementary.h"
#include "host_sim/soil_validation/bed_trials.h"
#include "host_sim/soil_validation/check_range.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/soil/soil_command.h"

namespace screed {
namespace {

struct ReposeArguments : SoilArguments {
  ReposeTest test;
};

SoilReport run_repose(ReposeArguments a) {
  a.test.soil = a.soil();
  a.test.cell_m = a.cell_m;
  const ReposeResult result = collapse(a.test);
  const double repose = a.test.soil.repose_deg;
  return {"repose",
          a.test.soil.name + text(", a tower of %g mm", a.test.height_m * kMilli) +
              text(", grid %g mm", a.cell_m * kMilli),
          "must be",
          {{"along the axes", "slope_deg", result.slope_axis_deg, "%.2f", repose,
            SoilLine::Error::kRelative},
           {"along diagonals", "slope_deg", result.slope_diagonal_deg, "%.2f", repose,
            SoilLine::Error::kRelative},
           {"steepest pair", "excess_units", result.excess_units, "%.3f", 1.0},
           {"", "volume_error", static_cast<double>(result.volume_error), "%.0f", 0.0},
           {"", "moves", static_cast<double>(result.moves), "%.0f"}}};
}

void add_repose(Command& soil, Program& program) {
  const auto a = std::make_shared<ReposeArguments>();
  Command* command =
      add_soil_test(soil, program, "repose", "Let a column of soil collapse to its angle of repose",
                    a, run_repose);
  add_number(*command, "--size", a->test.size_m, "Side length of the bed [m]", {0.1, 10.0});
  add_number(*command, "--radius", a->test.radius_m, "Radius of the column [m]", {0.0005, 10.0});
  add_number(*command, "--height", a->test.height_m, "Height of the column [m]", {1e-4, 10.0});
  add_number(*command, "--tap", a->test.tap_m,
             "Depth by which a plate first taps the column [m]; 0: untouched", {0.0, 1.0});
  add_number(*command, "--x", a->test.centre_x_m, "Centre position in x [m]", {-10.0, 10.0});
  add_number(*command, "--y", a->test.centre_y_m, "Centre position in y [m]", {-10.0, 10.0});
  command->add_flag("--wrap", a->test.wrap, "Wrap the bed around at its edges");
}

// ---- robot

struct RobotArguments : SoilArguments {
  double size_m = 2.0;
  bool wrap = false;
  double duration_s = 5.0;
  double left_m_per_s = 0.2;
  double right_m_per_s = 0.2;
  double relief_m = 0.0;
  double x_m = -0.5;
  double y_m = 0.0;
};

/// Milliseconds a step of Chrono's SCM with its default rays (docs/studies/soil.md).
std::optional<double> peer_step_us(const RobotArguments& a) {
  if (!a.as_peer() || a.size_m != 2.0) return std::nullopt;
  constexpr struct {
    double cell_m;
    double plain_us;
    double bulldozing_us;
  } kPeer[] = {{0.01, 93.5, 366.0}, {0.005, 237.0, 699.0}, {0.0025, 926.0, 1770.0}};
  for (const auto& row : kPeer) {
    if (std::abs(row.cell_m - a.cell_m) < 1e-9) {
      return a.bulldozing ? row.bulldozing_us : row.plain_us;
    }
  }
  return std::nullopt;
}

SoilReport run_robot(RobotArguments a) {
  const int nodes = static_cast<int>(std::lround(a.size_m / a.cell_m)) + (a.wrap ? 0 : 1);
  const double period = nodes * a.cell_m;
  const auto waves = [&](double x, double y) {
    const double k = 2.0 * std::numbers::pi / period;
    return 0.5 * a.relief_m * (portable::sin(2.0 * k * x) * portable::cos(3.0 * k * y));
  };
  const SoilParameters soil = a.soil();
  SoilBed bed(HeightField::from_function(nodes, nodes, a.cell_m, a.wrap, waves), soil, a.options());
  SoilRobot robot(bed, {}, a.x_m, a.y_m);
  const double dt = a.step_s;
  const auto steps = static_cast<int64_t>(std::llround(a.duration_s / dt));
  const int64_t untimed = steps / 5;
  std::clock_t begin = std::clock();
  const double level = robot.position().z();
  double load = 0.0;
  double distance = 0.0;
  TaskBar bar(false);
  const TaskProgress progress = bar.progress();
  for (int64_t i = 0; i < steps; ++i) {
    constexpr int64_t kReportSteps = 100;
    if (i % kReportSteps == 0)
      report_progress(progress, "driving", static_cast<double>(i) / static_cast<double>(steps));
    if (i == untimed) begin = std::clock();
    robot.step(a.left_m_per_s, a.right_m_per_s, dt);
    if (i >= untimed) load += robot.load_n();
    distance += dt * robot.velocity().head<2>().norm();
  }
  bar.clear();
  const auto timed = static_cast<double>(steps - untimed);
  const double us = static_cast<double>(std::clock() - begin) * 1e6 / CLOCKS_PER_SEC / timed;
  const Eigen::Vector3d place = robot.position();
  std::vector<SoilLine> lines = {
      {"", "step_us", us, "%.2f", std::nullopt, SoilLine::Error::kNone, peer_step_us(a)},
      {"", "mean_load_n", load / timed, "%.4f"},
      {"", "lower_by_mm", (level - place.z()) * kMilli, "%.3f"},
      {"", "distance_m", distance, "%.4f"},
      {"", "away_m", portable::hypot(place.x() - a.x_m, place.y() - a.y_m), "%.4f"},
      {"", "speed_m_per_s", robot.velocity().dot(robot.rotation().col(0)), "%.4f"},
      {"", "volume_error", static_cast<double>(bed.balance().error()), "%.0f", 0.0},
      {"", "volume_in_transit", static_cast<double>(bed.balance().in_transit), "%.0f"},
      {"", "compacted_cm3",
       static_cast<double>(bed.balance().compacted) * kHeightUnit_m * a.cell_m * a.cell_m * 1e6,
       "%.3f"},
  };
  const std::string hash = surface_hash(bed.surface());
  if (a.avalanches) {
    bed.relax_slopes();
    lines.push_back({"settled", "excess_units", repose_excess_units(bed.surface(), soil.repose_deg),
                     "%.3f", 1.0});
    lines.push_back(
        {"settled", "volume_error", static_cast<double>(bed.balance().error()), "%.0f", 0.0});
  }
  return {"robot",
          soil.name + text(", robot on a bed of %g m", a.size_m) +
              text(", grid %g mm", a.cell_m * kMilli) + text(", %g s in steps", a.duration_s) +
              text(" of %g ms", dt * kMilli),
          "must be",
          lines,
          {{"steps", steps}, {"heights_hash", hash}},
          "\nheights " + hash + "\n"};
}

void add_robot(Command& soil, Program& program) {
  const auto a = std::make_shared<RobotArguments>();
  Command* command =
      add_soil_test(soil, program, "robot",
                    "Drive a four-wheeled body: CPU time per step, volume balance", a, run_robot);
  add_number(*command, "--size", a->size_m, "Side length of the bed [m]", {0.5, 20.0});
  command->add_flag("--wrap", a->wrap, "Wrap the bed around at its edges");
  add_number(*command, "--relief", a->relief_m, "Amplitude of the waves on the bed [m]",
             {0.0, 0.1});
  add_number(*command, "--duration", a->duration_s, "Duration [s]; the first fifth is not timed",
             {0.01, 1e5});
  add_number(*command, "--left", a->left_m_per_s, "Rim speed of the left wheels [m/s]",
             {-10.0, 10.0});
  add_number(*command, "--right", a->right_m_per_s, "Rim speed of the right wheels [m/s]",
             {-10.0, 10.0});
  add_number(*command, "--x", a->x_m, "Start position in x [m]", {-10.0, 10.0});
  add_number(*command, "--y", a->y_m, "Start position in y [m]", {-10.0, 10.0});
}

}  // namespace

void register_soil_repose_command(Command& soil, Program& program) {
  add_repose(soil, program);
  add_robot(soil, program);
}

}  // namespace screed
