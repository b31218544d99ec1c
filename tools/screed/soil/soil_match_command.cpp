// `screed soil match`: what soil a bed of particles is like.
#include <cmath>
#include <memory>

#include "host_sim/core/elementary.h"
#include "host_sim/soil_validation/particle_plate.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/soil/soil_common.h"

namespace screed {
namespace {

struct MatchArguments {
  SoilArguments common;
  ParticlePlateTest test;
};

int run_match(const MatchArguments& a) {
  const SoilParameters soil = a.common.soil();
  std::vector<SoilLine> lines;
  TaskBar bar(false);
  for (const ParticlePlatePoint& point : press_particles(a.test, bar.progress())) {
    const std::string where = text("plate, %g kPa", point.pressure_pa / kMilli);
    const double bekker = soil.k_c / std::min(a.test.length_m, a.test.width_m) + soil.k_phi;
    const double depth = portable::pow(point.pressure_pa / bekker, 1.0 / soil.exponent);
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
  return finish(
      a.common, "match",
      text("particles of radius %g mm beside ", a.test.particle.radius_m * kMilli) + soil.name,
      soil.name.c_str(), lines);
}

}  // namespace

void register_soil_match_command(Command& soil, Program& program) {
  const auto a = std::make_shared<MatchArguments>();
  Command* command = soil.add_subcommand(
      "match", "Identify the soil parameters of a particle bed: press a plate, drag a block");
  a->common.preset = "gravel";
  add_soil_options(*command, a->common);
  a->test.particle.radius_m = 0.0075;
  add_number(*command, "--particle-radius", a->test.particle.radius_m, "Particle radius [m]",
             {0.002, 0.1});
  add_number(*command, "--particle-friction", a->test.particle.friction,
             "Friction coefficient of the particles", {0.0, 2.0});
  add_number(*command, "--depth", a->test.depth_m, "Depth of the particle bed [m]", {0.02, 1.0});
  add_number(*command, "--length", a->test.length_m, "Length of plate and block [m]", {0.02, 0.3});
  add_number(*command, "--width", a->test.width_m, "Width of plate and block [m]", {0.02, 0.3});
  add_number(*command, "--load", a->test.load_pa, "Pressure below the block [Pa]", {100.0, 1e5});
  add_number(*command, "--seed", a->test.seed, "Seed of the particle layout", kSeedRange);
  add_number(*command, "--beds", a->test.beds, "Number of particle beds to average over", {1, 64});
  command->callback([a, &program] { program.action = [a] { return run_match(*a); }; });
}

}  // namespace screed
