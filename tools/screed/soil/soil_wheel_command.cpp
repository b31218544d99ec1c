// `screed soil wheel`: a wheel on soil or particles beside its limit and beside measurements; the
// limit alone.

#include <cmath>
#include <iostream>
#include <limits>
#include <memory>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/data_folders.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/soil_validation/soil_measurements.h"
#include "host_sim/soil_validation/wheel_testbed.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/soil/soil_command.h"
#include "tools/screed/soil/wheel_charts.h"

namespace screed {
namespace {

struct WheelArguments : SoilArguments {
  WheelTest test;
  double yaw_deg = 0.0;
  std::vector<double> slips = {0.0, 0.2, 0.4};
  std::string measured;
  const Option* measured_option = nullptr;
  std::string cases = "ding2011_smooth";
  std::vector<double> slip_angles_deg = {0.0};
  bool limit_only = false;
  std::string schedule;
  std::vector<double> rims_m_per_s;
  std::string series;
  double rim_friction_deg = 90.0;
  std::string ground = "scm";
  ParticleMaterial particle;
  int beds = 1;
};

/// Chrono's SCM (exact rays) for Ding's wheel: slip, drawbar pull N, sinkage m
/// (docs/studies/soil.md).
struct PeerWheel {
  double slip;
  double drawbar_pull_n;
};
constexpr PeerWheel kPeerDing[] = {{0.1, 11.2}, {0.2, 23.9}, {0.3, 33.8}, {0.4, 41.2}, {0.6, 49.2}};

void write_charts(const WheelArguments& a, const std::vector<WheelChart>& charts) {
  for (const WheelChart& one : charts) write_chart(a.chart(one.file.c_str()), one.chart);
}

std::string wheel_text(const RollingWheel& wheel) {
  return text("wheel r %g", wheel.radius_m * kMilli) +
         text(" mm, width %g mm", wheel.width_m * kMilli) + text(", load %g N", wheel.load_n);
}

std::string ground_name(const WheelArguments& a) {
  if (!a.test.particle) return a.soil().name;
  return text("particles of radius %g mm", a.particle.radius_m * kMilli);
}

Json ground_json(const WheelArguments& a) {
  if (!a.test.particle) return Json::object();
  return {{"particles", particles_json(a.particle, a.test.depth_m, a.test.seed, a.beds)}};
}

std::string wheel_words(const WheelArguments& a) {
  if (a.test.particle) {
    return ground_name(a) + ", " + wheel_text(a.test.wheel) + text(", beds: %g", a.beds);
  }
  return a.soil().name + ", " + wheel_text(a.test.wheel) +
         (a.limit_only
              ? ", limit of an infinitely fine grid"
              : text(", grid %g mm", a.cell_m * kMilli) + text(", step %g ms", a.step_s * kMilli)) +
         ", normal stress " + a.normal_stress;
}

std::string where_of(const RollingWheel& wheel, bool with_angle) {
  return text("slip %g", wheel.slip) +
         (with_angle ? text(", angle %g", wheel.slip_angle_rad / kDegree) : "");
}

WheelReaction reaction_of(const WheelPass& pass) {
  WheelReaction reaction;
  reaction.sinkage_m = pass.sinkage_m;
  reaction.drawbar_pull_n = pass.drawbar_pull_n;
  reaction.side_force_n = pass.side_force_n;
  return reaction;
}

/// A row of measurements with what was computed for it in the place of what was measured.
MeasuredWheel computed_row(const MeasuredWheel& row, const WheelReaction& computed) {
  MeasuredWheel out;
  out.name = row.name;
  out.wheel = row.wheel;
  out.sinkage_m = computed.sinkage_m;
  out.drawbar_pull_n = computed.drawbar_pull_n;
  out.side_force_n = computed.side_force_n;
  return out;
}

/// A wheel that moves as a schedule says, once a bed. Beds of particles differ by their seed; of
/// soil there is one.
std::vector<std::vector<WheelSample>> run_beds(WheelTest test, const WheelSchedule& schedule,
                                               double interval_s, int beds) {
  std::vector<std::vector<WheelSample>> runs;
  for (int bed = 0; bed < beds; ++bed) {
    runs.push_back(run_wheel(test, schedule, interval_s).samples);
    ++test.seed;
  }
  return runs;
}

/// Sample by sample.
std::vector<WheelSample> mean_of(const std::vector<std::vector<WheelSample>>& runs) {
  std::vector<WheelSample> mean = runs.front();
  if (runs.size() == 1) return mean;
  const auto count = static_cast<double>(runs.size());
  for (size_t i = 0; i < mean.size(); ++i) {
    for (double WheelSample::*figure :
         {&WheelSample::sinkage_m, &WheelSample::drawbar_pull_n, &WheelSample::side_force_n}) {
      mean[i].*figure = 0.0;
      for (const std::vector<WheelSample>& run : runs) mean[i].*figure += run[i].*figure / count;
    }
  }
  return mean;
}

/// Wheels whose rim goes over to another speed, beside measurements.
SoilReport run_transients(WheelArguments a, const std::vector<MeasuredTransient>& transients) {
  constexpr double kInterval_s = 0.02;
  const RollingWheel rim = a.test.wheel;
  std::vector<SoilLine> lines;
  std::vector<TransientComparison> comparisons;
  ProgressBar bar(std::cerr);
  for (const MeasuredTransient& measured : transients) {
    bar.show_share(static_cast<double>(comparisons.size()) / static_cast<double>(transients.size()),
                   "rolling a wheel");
    a.test.wheel = measured.wheel;
    a.test.wheel.friction = rim.friction;
    a.test.wheel.adhesion_pa = rim.adhesion_pa;
    const WheelSchedule schedule = measured.schedule();
    const auto runs = run_beds(a.test, schedule, kInterval_s, a.beds);
    const TransientComparison one = {measured, mean_of(runs)};
    const std::vector<double> extra = measured.extra_sinkage_m(one.screed);
    std::vector<double> squares(extra.size());  // of what single beds are off
    for (const auto& run : runs) {
      const std::vector<double> here = measured.extra_sinkage_m(run);
      for (size_t i = 0; i < extra.size(); ++i)
        squares[i] += (here[i] - extra[i]) * (here[i] - extra[i]);
    }
    for (size_t i = 0; i < extra.size(); ++i) {
      const std::string where =
          measured.name + text(", slip path %g mm", measured.places[i].slip_path_m * kMilli);
      lines.push_back({where, "extra_sinkage_mm", extra[i] * kMilli, "%.2f",
                       measured.places[i].extra_sinkage_m * kMilli, SoilLine::Error::kAbsolute});
      if (a.beds < 2) continue;
      lines.push_back({where, "standard_error_mm",
                       std::sqrt(squares[i] / (a.beds * (a.beds - 1.0))) * kMilli, "%.2f"});
    }
    comparisons.push_back(one);
  }
  bar.clear();
  if (!a.charts.empty()) write_charts(a, {transient_chart(ground_name(a), comparisons)});
  return {"wheel_transient", wheel_words(a), "measured", lines, ground_json(a)};
}

SoilReport run_measured(WheelArguments a) {
  const SoilMeasurements measured = read_soil_measurements(a.measured, a.cases);
  if (!measured.transients.empty()) return run_transients(a, measured.transients);
  const std::vector<MeasuredWheel>& rows = measured.wheels;
  const NormalStress stress = a.test.options.normal_stress;
  const RollingWheel rim = a.test.wheel;
  std::vector<SoilLine> lines;
  WheelComparison comparison;
  comparison.cases = a.cases;
  comparison.subtitle = (a.cases.empty() ? "" : a.cases + " on ") + a.soil().name;
  comparison.measured = rows;
  ProgressBar bar(std::cerr);
  for (const MeasuredWheel& row : rows) {
    bar.show_share(static_cast<double>(&row - rows.data()) / static_cast<double>(rows.size()),
                   "rolling a wheel");
    a.test.wheel = row.wheel;
    a.test.wheel.friction = rim.friction;
    a.test.wheel.adhesion_pa = rim.adhesion_pa;
    const WheelPass pass = run_wheel(a.test).passes[0];
    const WheelReaction limit = wheel_limit(a.test.wheel, a.test.soil, stress);
    std::optional<double> peer;
    for (const PeerWheel& known : kPeerDing) {
      if (a.cases == "ding2011_smooth" && std::abs(known.slip - row.wheel.slip) < 1e-9) {
        peer = known.drawbar_pull_n;
        comparison.chrono_pull.push_back({known.slip, *peer});
      }
    }
    const auto measured_mm = [](std::optional<double> m) {
      return m ? std::optional(*m * kMilli) : std::nullopt;
    };
    const std::string where = where_of(row.wheel, row.wheel.slip_angle_rad != 0.0);
    lines.push_back({where, "sinkage_mm", pass.sinkage_m * kMilli, "%.2f",
                     measured_mm(row.sinkage_m), SoilLine::Error::kRelative,
                     peer ? std::optional(8.65) : std::nullopt});
    lines.push_back({where, "drawbar_pull_n", pass.drawbar_pull_n, "%.2f", row.drawbar_pull_n,
                     SoilLine::Error::kAbsolute, peer});
    lines.push_back({where, "side_force_n", pass.side_force_n, "%.2f", row.side_force_n,
                     SoilLine::Error::kAbsolute});
    lines.push_back(
        {where, "torque_nm", pass.torque_nm, "%.2f", row.torque_nm, SoilLine::Error::kRelative});
    comparison.screed.push_back(computed_row(row, reaction_of(pass)));
    comparison.limit.push_back(computed_row(row, limit));
  }
  bar.clear();
  if (!a.charts.empty()) write_charts(a, measured_charts(comparison));
  return {"wheel", wheel_words(a), "measured", lines};
}

void write_series(const std::string& file, const std::vector<WheelSample>& samples) {
  std::string csv =
      "time_s,travel_m,slip_path_m,side_path_m,sinkage_m,drawbar_pull_n,side_force_n\n";
  for (const WheelSample& at : samples) {
    csv += text("%.3f", at.time_s) + text(",%.6f", at.travel_m) + text(",%.6f", at.slip_path_m) +
           text(",%.6f", at.side_path_m) + text(",%.6f", at.sinkage_m) +
           text(",%.4f", at.drawbar_pull_n) + text(",%.4f\n", at.side_force_n);
  }
  write_file(file, csv);
}

/// A wheel or belt that moves as a schedule says.
SoilReport run_scheduled(const WheelArguments& a) {
  constexpr double kInterval_s = 0.05;
  constexpr size_t kLines = 20;
  const WheelSchedule schedule = read_wheel_schedule(a.schedule);
  const std::vector<WheelSample> samples = mean_of(run_beds(a.test, schedule, kInterval_s, a.beds));
  if (!a.series.empty()) write_series(a.series, samples);
  if (!a.charts.empty()) write_charts(a, schedule_charts(ground_name(a), samples));
  std::vector<SoilLine> lines;
  const size_t last = samples.size() - 1;
  const size_t parts = std::max<size_t>(1, std::min(kLines, last));
  for (size_t line = 0; line <= parts; ++line) {
    const WheelSample& at = samples[line * last / parts];
    const std::string where =
        text("%.2f s", at.time_s) + text(", slip path %.1f mm", at.slip_path_m * kMilli);
    lines.push_back({where, "sinkage_mm", at.sinkage_m * kMilli, "%.3f"});
    lines.push_back({where, "drawbar_pull_n", at.drawbar_pull_n, "%.3f"});
    lines.push_back({where, "side_force_n", at.side_force_n, "%.3f"});
  }
  return {"wheel_schedule", wheel_words(a), "", lines, ground_json(a)};
}

struct SteadyWheel {
  double sinkage_m = 0.0;
  double drawbar_pull_n = 0.0;
  double side_force_n = 0.0;
};

/// Means over the last fifth.
SteadyWheel steady_state(const std::vector<WheelSample>& samples) {
  SteadyWheel mean;
  const size_t first = samples.size() - std::max<size_t>(1, samples.size() / 5);
  const auto count = static_cast<double>(samples.size() - first);
  for (size_t i = first; i < samples.size(); ++i) {
    mean.sinkage_m += samples[i].sinkage_m / count;
    mean.drawbar_pull_n += samples[i].drawbar_pull_n / count;
    mean.side_force_n += samples[i].side_force_n / count;
  }
  return mean;
}

/// Wheels that roll without slip until their rims go over to other speeds.
SoilReport run_steps_of_slip(const WheelArguments& a) {
  constexpr double kInterval_s = 0.01;
  constexpr double kTimeConstant_s = 0.13;  // of data/soil/slip_transients_cmu2022.csv
  constexpr double kPaths_m[] = {0.0,  0.002, 0.004, 0.009, 0.015, 0.025,
                                 0.04, 0.06,  0.1,   0.15,  0.23,  0.4};
  std::vector<SoilLine> lines;
  std::string csv =
      "slip_angle_deg,rim_m_s,slip_path_m,steady,sinkage_m,drawbar_pull_n,side_force_n\n";
  ProgressBar bar(std::cerr);
  for (const double angle_deg : a.slip_angles_deg) {
    for (const double rim : a.rims_m_per_s) {
      bar.show_share(
          static_cast<double>(lines.size()) /
              (4.0 * static_cast<double>(a.slip_angles_deg.size() * a.rims_m_per_s.size())),
          "rolling a wheel");
      const WheelSchedule schedule = step_of_slip(a.test.speed_m_per_s, angle_deg * kDegree, rim,
                                                  kTimeConstant_s, a.test.duration_s);
      const std::vector<WheelSample> samples =
          mean_of(run_beds(a.test, schedule, kInterval_s, a.beds));
      const std::string begin = text("%g,", angle_deg) + text("%g,", rim);
      const auto add = [&](const std::string& where, const SteadyWheel& at) {
        csv += begin + where + text(",%.5f", at.sinkage_m) + text(",%.3f", at.drawbar_pull_n) +
               text(",%.3f\n", at.side_force_n);
      };
      size_t next = 0;
      for (const WheelSample& at : samples) {
        if (next == std::size(kPaths_m)) break;
        if (portable::hypot(at.slip_path_m, at.side_path_m) < kPaths_m[next]) continue;
        add(text("%g,0", kPaths_m[next]), {at.sinkage_m, at.drawbar_pull_n, at.side_force_n});
        ++next;
      }
      const SteadyWheel steady = steady_state(samples);
      add(",1", steady);
      const std::string where = text("angle %g", angle_deg) + text(", rim %g mm/s", rim * kMilli);
      lines.push_back({where, "start_sinkage_mm", samples.front().sinkage_m * kMilli, "%.2f"});
      lines.push_back({where, "steady_sinkage_mm", steady.sinkage_m * kMilli, "%.2f"});
      lines.push_back({where, "steady_pull_n", steady.drawbar_pull_n, "%.3f"});
      lines.push_back({where, "steady_side_force_n", steady.side_force_n, "%.3f"});
    }
  }
  bar.clear();
  if (!a.series.empty()) write_file(a.series, csv);
  return {"wheel_step", wheel_words(a), "", lines, ground_json(a)};
}

/// Lines of one pass of a wheel beside its limit.
void add_lines(std::vector<SoilLine>& lines, const WheelArguments& a, const std::string& where,
               const WheelPass& pass, const WheelReaction& limit) {
  // The limit is that of soil that stays where it is.
  const auto unmoved = [&](double value) {
    return a.bulldozing ? std::nullopt : std::optional(value);
  };
  lines.push_back({where, "sinkage_mm", pass.sinkage_m * kMilli, "%.4f",
                   unmoved(limit.sinkage_m * kMilli), SoilLine::Error::kRelative});
  lines.push_back({where, "drawbar_pull_n", pass.drawbar_pull_n, "%.5f",
                   unmoved(limit.drawbar_pull_n), SoilLine::Error::kAbsolute});
  if (a.test.wheel.slip_angle_rad != 0.0) {
    lines.push_back({where, "side_force_n", pass.side_force_n, "%.5f", unmoved(limit.side_force_n),
                     SoilLine::Error::kAbsolute});
  }
  lines.push_back({where, "torque_nm", pass.torque_nm, "%.6f", unmoved(limit.torque_nm),
                   SoilLine::Error::kAbsolute});
  lines.push_back({where, "rut_mm", pass.rut_m * kMilli, "%.4f", unmoved(limit.rut_m * kMilli),
                   SoilLine::Error::kRelative});
  lines.push_back({where, "ripple_mm", pass.ripple_m * kMilli, "%.4f"});
}

/// Lines of a limit alone.
void add_lines(std::vector<SoilLine>& lines, const WheelArguments& a, const std::string& where,
               const WheelReaction& limit) {
  lines.push_back({where, "sinkage_mm", limit.sinkage_m * kMilli, "%.4f"});
  lines.push_back({where, "drawbar_pull_n", limit.drawbar_pull_n, "%.5f"});
  if (a.test.wheel.slip_angle_rad != 0.0)
    lines.push_back({where, "side_force_n", limit.side_force_n, "%.5f"});
  lines.push_back({where, "torque_nm", limit.torque_nm, "%.6f"});
  lines.push_back({where, "rut_mm", limit.rut_m * kMilli, "%.4f"});
}

/// One slip angle and slip: the first pass beside the limit, as `screed` and `limit`.
struct FirstPass {
  WheelReaction screed;
  WheelReaction limit;
};

FirstPass roll(const WheelArguments& a, const std::string& place, std::vector<SoilLine>& lines) {
  FirstPass first;
  std::optional<WheelTestResult> result;
  if (!a.limit_only) result = run_wheel(a.test);
  RollingWheel rolling = a.test.wheel;
  for (int i = 0; i < a.test.passes; ++i) {
    std::string where = place;
    if (a.test.passes > 1) where += ", pass " + std::to_string(i + 1);
    const WheelReaction limit = wheel_limit(rolling, a.test.soil, a.test.options.normal_stress);
    rolling.rut_m = limit.rut_m;
    if (i == 0) first.limit = limit;
    if (!result) {
      add_lines(lines, a, where, limit);
      continue;
    }
    const WheelPass& pass = result->passes[static_cast<size_t>(i)];
    if (i == 0) first.screed = reaction_of(pass);
    add_lines(lines, a, where, pass, limit);
  }
  if (result) {
    lines.push_back(
        {place, "volume_error", static_cast<double>(result->balance.error()), "%.0f", 0.0});
  }
  return first;
}

SoilReport run_wheel_command(WheelArguments a) {
  a.set(a.test);
  a.test.yaw_rad = a.yaw_deg * kDegree;
  if (a.ground == "particles") {
    a.test.particle = a.particle;
  } else if (a.ground != "scm" || a.beds != 1) {
    throw InputError("wheel: --ground " + a.ground + ", --beds " + std::to_string(a.beds) +
                     "; allowed is scm with one bed, or particles");
  }
  a.test.wheel.friction = a.rim_friction_deg >= 90.0 ? std::numeric_limits<double>::infinity()
                                                     : portable::tan(a.rim_friction_deg * kDegree);
  if (a.measured_option->given()) {
    if (a.measured.empty()) {
      a.measured = (data_folders().data / "soil" / "single_wheel_ding2011.csv").string();
    }
    return run_measured(a);
  }
  if (!a.schedule.empty()) return run_scheduled(a);
  if (!a.rims_m_per_s.empty()) return run_steps_of_slip(a);
  if (a.test.belt_m > 0.0 || a.test.lug_height_m > 0.0 || !a.series.empty() || a.test.particle) {
    throw InputError(
        "wheel: --belt, --lug-height and --series need --schedule or --rim; --ground particles "
        "needs one of them or measured transients");
  }
  for (const double angle : a.slip_angles_deg) {
    if (std::abs(angle) > 80.0) {
      throw InputError("wheel: --slip-angle " + shortest(angle) +
                       "; allowed is -80 to 80, more with --rim");
    }
  }
  const bool several = a.slip_angles_deg.size() > 1;
  const auto runs = static_cast<double>(a.slip_angles_deg.size() * a.slips.size());
  int done = 0;
  bool sideways = false;
  std::vector<SoilLine> lines;
  std::vector<WheelCurve> curves;
  ProgressBar bar(std::cerr);
  for (const double angle_deg : a.slip_angles_deg) {
    a.test.wheel.slip_angle_rad = angle_deg * kDegree;
    sideways = sideways || angle_deg != 0.0;
    const std::string angle = text("%g deg", angle_deg);
    WheelCurve screed{several ? "Screed, " + angle : "Screed", true, a.slips, {}};
    WheelCurve limit{several ? "limit, " + angle : "limit", false, a.slips, {}};
    for (const double slip : a.slips) {
      bar.show_share(done++ / runs, "rolling a wheel");
      a.test.wheel.slip = slip;
      const FirstPass first = roll(a, where_of(a.test.wheel, several), lines);
      screed.reactions.push_back(first.screed);
      limit.reactions.push_back(first.limit);
    }
    if (!a.limit_only) curves.push_back(screed);
    curves.push_back(limit);
  }
  bar.clear();
  if (!a.charts.empty()) {
    WheelSweep sweep;
    const bool radial = a.test.options.normal_stress == NormalStress::kRadial;
    sweep.prefix = a.limit_only ? "limit" : radial ? "wheel_radial" : "wheel_vertical";
    sweep.subject = a.soil().name + ", normal stress " + a.normal_stress;
    if (a.limit_only) sweep.subtitle = wheel_text(a.test.wheel);
    sweep.curves = curves;
    sweep.with_side_force = sideways;
    write_charts(a, wheel_charts(sweep));
  }
  return {a.limit_only ? "wheel_limit" : "wheel", wheel_words(a), a.limit_only ? "" : "limit",
          lines};
}

}  // namespace

void register_soil_wheel_command(Command& soil, Program& program) {
  const auto a = std::make_shared<WheelArguments>();
  Command* command = add_soil_test(
      soil, program, "wheel",
      "Roll a wheel at imposed slip and compare with the limit of an infinitely fine grid", a,
      run_wheel_command);
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
  add_number(*command, "--slip-angle", a->slip_angles_deg,
             "Angle of travel to the left of the wheel's plane [deg]; several with commas between "
             "them",
             {-90.0, 90.0});
  Option* limit_only = command->add_flag("--limit-only", a->limit_only,
                                         "Compute the limit alone, in an instant; roll no wheel");
  Option* schedule =
      command
          ->add_option(
              "--schedule", a->schedule,
              "Move the wheel as a CSV file says: time_s, rim_m_s, travel_m_s, slip_angle_deg")
          ->type_name("FILE");
  schedule->excludes(limit_only);
  add_number(
      *command, "--rim", a->rims_m_per_s,
      "Roll at --speed without slip until the rim goes over to this speed [m/s]; several with "
      "commas between them",
      {-10.0, 10.0})
      ->excludes(limit_only)
      ->excludes(schedule);
  command
      ->add_option("--series", a->series,
                   "With --schedule or --rim: a CSV file for what the wheel does over time")
      ->type_name("FILE");
  add_number(*command, "--belt", a->test.belt_m,
             "With --schedule or --rim: a belt round two wheels, so far apart, kept level [m]",
             {0.0, 10.0});
  add_number(*command, "--lug-height", a->test.lug_height_m,
             "With --schedule or --rim: height of the surface's lugs [m]", {0.0, 0.1});
  add_number(*command, "--rim-friction", a->rim_friction_deg,
             "Angle of friction between rim and soil [deg]; 90: rough, soil shears on soil",
             {0.0, 90.0});
  add_number(*command, "--rim-adhesion", a->test.wheel.adhesion_pa,
             "Adhesion of soil to the rim [Pa]", {0.0, 1e7});
  Option* measured =
      command
          ->add_option("--measured", a->measured,
                       "Compare with measurements: a CSV file (default: Ding et al. 2011)")
          ->type_name("FILE");
  measured->expected(0, 1)->excludes(limit_only);
  command->add_option("--case", a->cases, "Use the rows whose case begins with this text")
      ->show_default()
      ->type_name("CASE");
  command
      ->add_option("--ground", a->ground,
                   "Terrain model: scm or particles; particles need --schedule, --rim or measured "
                   "transients")
      ->show_default();
  a->particle.radius_m = 0.006;
  add_particle_options(*command, a->particle, a->test.depth_m, a->test.seed);
  add_number(*command, "--beds", a->beds, "Number of particle beds to average over", {1, 64});
  command->add_option("--charts", a->charts, "Output folder for SVG charts")->type_name("FOLDER");
  a->measured_option = measured;
}

}  // namespace screed
