// Traps as heights over the distance from the start.
#include "host_sim/run/experiment/trap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/core/elementary.h"

namespace screed {
namespace {

constexpr double kSteep_m = 0.02;       // over which a wall rises
constexpr double kGentle_m = 0.08;      // over which one drives down into ruts and trenches
constexpr double kSlopeLength_m = 1.2;  // level behind it
constexpr double kTrench_m = 0.35;
constexpr double kRuts_m = 0.5;
constexpr double kHalfHump_m = 0.04;  // of 0.16 m between the tracks
constexpr double kHalfGauge_m = 0.0975;
constexpr double kHalfRut_m = 0.035;

struct TrapPosition {
  double around;  ///< from the start, m
  double ahead;   ///< along the heading at the start, m
  double left;
};

struct TrapKind {
  const char* name;
  double (*height)(const TrapPosition& position, double distance, double size);
};

double smooth_step(double t) {
  const double within = std::clamp(t, 0.0, 1.0);
  return within * within * (3.0 - 2.0 * within);
}

/// 1 between begin and begin + length.
double dip(double along, double length) {
  return smooth_step(along / kGentle_m) - smooth_step((along - length) / kSteep_m);
}

constexpr TrapKind kTraps[] = {
    {"none",
     [](const TrapPosition& /*position*/, double /*distance*/, double /*size*/) { return 0.0; }},
    {"wall",
     [](const TrapPosition& position, double distance, double size) {
       return size * smooth_step((position.around - distance) / kSteep_m);
     }},
    {"slope",
     [](const TrapPosition& position, double distance, double size) {
       return portable::tan(size * std::numbers::pi / 180.0) *
              std::clamp(position.around - distance, 0.0, kSlopeLength_m);
     }},
    {"trench", [](const TrapPosition& position, double distance,
                  double size) { return -size * dip(position.around - distance, kTrench_m); }},
    {"hump",
     [](const TrapPosition& position, double distance, double size) {
       return std::abs(position.left) < kHalfHump_m
                  ? size * smooth_step((position.ahead - distance) / 0.1)
                  : 0.0;
     }},
    {"ruts",
     [](const TrapPosition& position, double distance, double size) {
       return std::abs(std::abs(position.left) - kHalfGauge_m) < kHalfRut_m
                  ? -size * dip(position.ahead - distance, kRuts_m)
                  : 0.0;
     }},
};

const TrapKind* trap_named(const std::string& name) {
  const auto* const found = std::find_if(std::begin(kTraps), std::end(kTraps),
                                         [&](const TrapKind& kind) { return name == kind.name; });
  return found == std::end(kTraps) ? nullptr : found;
}

}  // namespace

std::vector<std::string> trap_kinds() {
  std::vector<std::string> names;
  for (const TrapKind& kind : kTraps) names.emplace_back(kind.name);
  return names;
}

void set_trap(const Experiment& experiment, HeightField& field) {
  const TrapKind* const trap = trap_named(experiment.trap.kind);
  if (trap == nullptr || trap == std::begin(kTraps)) return;
  const auto [sine, cosine] =
      portable::sine_cosine(experiment.vehicle.heading_deg * std::numbers::pi / 180.0);
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double east = field.node_x(ix) - experiment.vehicle.x_m;
      const double north = field.node_y(iy) - experiment.vehicle.y_m;
      const TrapPosition position = {portable::hypot(east, north), east * cosine + north * sine,
                                     north * cosine - east * sine};
      const double height =
          trap->height(position, experiment.trap.distance_m, experiment.trap.size);
      if (height == 0.0) continue;
      const double units = static_cast<double>(field.node(ix, iy)) + height / kHeightUnit_m;
      field.set_node(ix, iy, static_cast<Height>(std::clamp(units, -2.1e9, 2.1e9)));
    }
  }
  field.refresh_bounds();
}

}  // namespace screed
