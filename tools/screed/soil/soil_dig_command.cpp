// `screed soil dig`: a tracked robot digs, on deformable soil and on particles.

#include <algorithm>
#include <cmath>
#include <memory>

#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/soil_validation/dig_test.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/soil/soil_command.h"

namespace screed {
namespace {

struct DigArguments : SoilArguments {
  DigTest test;
  std::string manoeuvre = "spin";
  std::string ground = "scm";
  double fit_cm3 = 0.0;
};

constexpr std::pair<const char*, Manoeuvre> kManoeuvres[] = {{"spin", Manoeuvre::kSpin},
                                                             {"charge", Manoeuvre::kCharge},
                                                             {"slip", Manoeuvre::kSlip},
                                                             {"strokes", Manoeuvre::kStrokes}};

Manoeuvre manoeuvre_named(const std::string& name) {
  for (const auto& [known, manoeuvre] : kManoeuvres) {
    if (name == known) return manoeuvre;
  }
  throw InputError("dig: manoeuvre = " + name + "; allowed is spin, charge, slip or strokes");
}

/// The slip layer with which the robot raises so much, to 0.1 mm: the nearest of a row, then
/// between its neighbours.
double fit_slip_layer(DigTest test, double raised_m3, const TaskProgress& progress) {
  constexpr double kMaxDrives = 34.0;
  int drives = 0;
  const auto miss = [&](double slip_layer_m) {
    test.soil.slip_layer_m = slip_layer_m;
    const TaskProgress of_drive = [&](std::string_view /*digging*/, double share) {
      report_progress(progress, "fitting the slip layer", (drives + share) / kMaxDrives);
    };
    const double error = std::abs(dig_soil(test, of_drive).raised_m3 - raised_m3);
    ++drives;
    return error;
  };
  double best = 0.0;
  double least = miss(best);
  for (const double step : {0.002, 0.0005, 0.0001}) {
    const double middle = best;
    for (int i = -4; i <= 6; ++i) {
      const double tried = middle + i * step;
      if (tried < 0.0 || tried > 0.05) continue;
      const double error = miss(tried);
      if (error >= least) continue;
      least = error;
      best = tried;
    }
  }
  return best;
}

/// "cmu_2022, slip_bearing 0.283 (fitted to wheels, 0.26 to 0.31), slip_carry 0.66 (assumed, 0 to
/// 1)"; of a soil that has no such name, or is changed, its name.
std::string how_well_known(const SoilParameters& soil) {
  const SlipEvidence* const evidence = slip_evidence(soil.name);
  if (evidence == nullptr) return soil.name;
  const auto describe = [](const char* key, double value, std::string_view source,
                           const std::array<double, 2>& range) {
    return std::string(", ") + key + " " + shortest(value) + " (" + std::string(source) + ", " +
           shortest(range[0]) + " to " + shortest(range[1]) + ")";
  };
  return soil.name +
         describe("slip_bearing", soil.slip_bearing, evidence->bearing, evidence->bearing_range) +
         describe("slip_carry", soil.slip_carry, evidence->carry, evidence->carry_range);
}

SoilReport run_dig(DigArguments a) {
  a.test.manoeuvre = manoeuvre_named(a.manoeuvre);
  if (a.ground != "scm" && a.ground != "particles") {
    throw InputError("dig: ground = " + a.ground + "; allowed is scm or particles");
  }
  a.set(a.test);
  std::vector<SoilLine> lines;
  TaskBar bar(false);
  if (a.fit_cm3 > 0.0) {
    a.test.soil.slip_layer_m = fit_slip_layer(a.test, a.fit_cm3 * 1e-6, bar.progress());
    lines.push_back({"fitted", "slip_layer_mm", a.test.soil.slip_layer_m * kMilli, "%.1f"});
  }
  const bool particles = a.ground == "particles";
  const DigResult result =
      particles ? dig_particles(a.test, bar.progress()) : dig_soil(a.test, bar.progress());
  bar.clear();
  constexpr double kDegrees = 57.29577951308232;
  const auto add = [&](const char* name, double value, const char* format) {
    lines.push_back({a.manoeuvre, name, value, format});
  };
  add("raised_cm3", result.raised_m3 * 1e6, "%.1f");
  add("sunk_cm3", result.sunk_m3 * 1e6, "%.1f");
  if (particles && a.test.beds > 1) {
    add("raised_error_cm3", result.error.raised_m3 * 1e6, "%.1f");
    add("sunk_error_cm3", result.error.sunk_m3 * 1e6, "%.1f");
    add("raised_at_least_cm3", result.at_least.raised_m3 * 1e6, "%.1f");
    add("sunk_at_least_cm3", result.at_least.sunk_m3 * 1e6, "%.1f");
  }
  for (const DigOfBeds& few : result.of_beds) {
    const std::string test = a.manoeuvre + text(", means of %g beds", few.beds);
    lines.push_back({test, "raised_cm3", few.moved.raised_m3 * 1e6, "%.1f"});
    lines.push_back({test, "sunk_cm3", few.moved.sunk_m3 * 1e6, "%.1f"});
  }
  add("deepest_mm", result.deepest_m * kMilli, "%.2f");
  add("highest_mm", result.highest_m * kMilli, "%.2f");
  add("sunk_distance_mm", result.sunk_radius_m * kMilli, "%.1f");
  add("raised_distance_mm", result.raised_radius_m * kMilli, "%.1f");
  add("raised_behind_share", result.behind_share, "%.3f");
  if (a.test.slope_deg > 0.0) add("downhill_cm3m", result.downhill_m4 * 1e6, "%.3f");
  if (a.test.slope_deg > 0.0 && particles && a.test.beds > 1)
    add("downhill_error_cm3m", result.downhill_error_m4 * 1e6, "%.3f");
  add("carried_cm3m", result.carried_m4 * 1e6, "%.3f");
  if (particles && a.test.beds > 1)
    add("carried_error_cm3m", result.carried_error_m4 * 1e6, "%.3f");
  add("time_s", result.time_s, "%.2f");
  if (a.test.manoeuvre == Manoeuvre::kSlip) {
    add("sunk_cm3_per_s", result.sunk_m3 * 1e6 / result.time_s, "%.2f");
    add("carried_cm3m_per_s", result.carried_m4 * 1e6 / result.time_s, "%.3f");
    add("pull_n", result.pull_n, "%.2f");
  }
  add("distance_m", result.distance_m, "%.4f");
  if (a.test.manoeuvre == Manoeuvre::kStrokes) add("end_x_m", result.end_x_m, "%.4f");
  add("turned_deg", result.turned_rad * kDegrees, "%.1f");
  add("lower_by_mm", result.lower_by_m * kMilli, "%.2f");
  add("pitch_deg", result.pitch_rad * kDegrees, "%.2f");
  if (!particles) add("volume_error", static_cast<double>(result.balance.error()), "%.0f");
  Json more = Json::object();
  if (particles) {
    more["particles"] = particles_json(a.test.particle, a.test.depth_m, a.test.seed, a.test.beds);
  }
  if (!a.charts.empty()) {
    PictureOptions picture;
    picture.width_px = 800;
    picture.height_px = 700;
    picture.title = a.manoeuvre + (particles ? ", particles" : ", soil");
    const std::string file = "soil_dig_" + a.manoeuvre + "_" + a.ground + ".png";
    write_difference_picture(a.chart(file.c_str()), result.before, result.after, picture);
  }
  return {"dig",
          (particles ? text("particles of radius %g mm", a.test.particle.radius_m * kMilli)
                     : how_well_known(a.test.soil)) +
              text(", grid %g mm", a.cell_m * kMilli),
          "must be", lines, more};
}

}  // namespace

void register_soil_dig_command(Command& soil, Program& program) {
  const auto a = std::make_shared<DigArguments>();
  a->bulldozing = a->avalanches = true;
  a->preset = "gravel";
  Command* command =
      add_soil_test(soil, program, "dig",
                    "Let a tracked robot dig: moved volume, depth, distribution of the material", a,
                    run_dig, {.cell_m = {0.001, 0.02}, .step_s = {1e-5, 0.01}});
  a->test.particle.radius_m = 0.0075;
  command
      ->add_option("--manoeuvre", a->manoeuvre,
                   "Manoeuvre: spin, charge (a mound of 20 degrees), slip or strokes")
      ->show_default();
  command->add_option("--ground", a->ground, "Terrain model: scm or particles")->show_default();
  add_particle_options(*command, a->test.particle, a->test.depth_m, a->test.seed);
  add_number(*command, "--size", a->test.size_m, "Side length of the bed [m]", {0.5, 5.0});
  add_number(*command, "--track-speed", a->test.track_m_per_s, "Belt speed [m/s]", {0.01, 1.0});
  add_number(*command, "--duration", a->test.duration_s, "Duration [s]", {0.1, 600.0});
  add_number(*command, "--stroke", a->test.stroke_s, "Strokes: time at full speed ahead [s]",
             {0.0, 5.0});
  add_number(*command, "--stroke-back", a->test.stroke_back_s,
             "Strokes: time at full speed back [s]", {0.0, 5.0});
  add_number(*command, "--stroke-accel", a->test.stroke_accel_m_per_s2,
             "Strokes: acceleration of the belts into the way ahead [m/s^2]", {0.1, 100.0});
  add_number(*command, "--slip", a->test.slip, "Slip: of the belts", {0.05, 0.99});
  add_number(*command, "--lug-height", a->test.lug_height_m,
             "Height of the belts' tread, which takes soil along [m] (scm)", {0.0, 0.1});
  add_number(*command, "--slope", a->test.slope_deg,
             "Slope of the ground, rising to the east [deg]; a spinning robot is tethered to its "
             "place on it, a charge has none",
             {0.0, 25.0});
  add_number(*command, "--beds", a->test.beds, "Number of particle beds whose heights are averaged",
             {1, 256});
  add_number(*command, "--fit-raised", a->fit_cm3,
             "Fit --slip-layer to this raised volume [cm^3] (scm)", {0.0, 1e6});
  command->add_option("--charts", a->charts, "Output folder for a PNG of the height change")
      ->type_name("FOLDER");
}

}  // namespace screed
