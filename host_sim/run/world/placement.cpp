// Grid, ring, random places, and those of a list; walls, slopes and trenches round them.
#include "host_sim/run/world/placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/core/random.h"
#include "host_sim/run/experiment/experiment_keys.h"
#include "host_sim/run/experiment/robot_sections.h"

namespace screed {

namespace {

std::vector<RobotPlace> grid(const RobotsSection& robots, const RobotPlace& centre) {
  const uint32_t columns =
      static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(robots.count))));
  const uint32_t rows = (robots.count + columns - 1) / columns;
  std::vector<RobotPlace> places;
  for (uint32_t i = 0; i < robots.count; ++i) {
    const double column = i % columns - 0.5 * (columns - 1);
    const uint32_t whole_rows = i / columns;
    const double row = whole_rows - 0.5 * (rows - 1);
    places.push_back({centre.x_m + column * robots.spacing_m, centre.y_m + row * robots.spacing_m,
                      centre.heading_deg});
  }
  return places;
}

std::vector<RobotPlace> ring(const RobotsSection& robots, const RobotPlace& centre) {
  const double radius = 0.5 * robots.spacing_m / portable::sin(std::numbers::pi / robots.count);
  std::vector<RobotPlace> places;
  for (uint32_t i = 0; i < robots.count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / robots.count;
    places.push_back({centre.x_m + radius * portable::cos(angle),
                      centre.y_m + radius * portable::sin(angle),
                      centre.heading_deg + angle * 180.0 / std::numbers::pi});
  }
  return places;
}

/// Of two places, on a bed that wraps around by the shorter way.
double distance(const RobotPlace& a, const RobotPlace& b, const HeightField& terrain) {
  double dx = a.x_m - b.x_m;
  double dy = a.y_m - b.y_m;
  if (terrain.wrap()) {
    dx = std::remainder(dx, terrain.x_max() - terrain.x_min());
    dy = std::remainder(dy, terrain.y_max() - terrain.y_min());
  }
  return portable::hypot(dx, dy);
}

bool is_free(const RobotPlace& place, const std::vector<RobotPlace>& taken, double spacing_m,
             const HeightField& terrain) {
  for (const RobotPlace& other : taken) {
    if (distance(place, other, terrain) < spacing_m) return false;
  }
  return true;
}

std::vector<RobotPlace> random_places(const Experiment& experiment, const HeightField& terrain) {
  constexpr int kTries = 10000;  // of one robot
  const RobotsSection& robots = experiment.robots;
  const double edge_m = terrain.wrap() ? 0.0 : 0.5 * robots.spacing_m;
  WorldRandom random(experiment.experiment.seed, "places of robots");
  std::vector<RobotPlace> places;
  for (int tries = 0; places.size() < robots.count; ++tries) {
    if (tries == kTries || terrain.x_max() - terrain.x_min() <= 2.0 * edge_m ||
        terrain.y_max() - terrain.y_min() <= 2.0 * edge_m) {
      throw InputError("[robots] placement = random: " + std::to_string(robots.count) +
                       " robots with spacing = " + shortest(robots.spacing_m) +
                       " m found no places on this bed; allowed is a smaller spacing or count");
    }
    RobotPlace place;
    place.x_m = random.uniform(terrain.x_min() + edge_m, terrain.x_max() - edge_m);
    place.y_m = random.uniform(terrain.y_min() + edge_m, terrain.y_max() - edge_m);
    place.heading_deg = random.uniform(-180.0, 180.0);
    if (!is_free(place, places, robots.spacing_m, terrain)) continue;
    places.push_back(place);
    tries = 0;
  }
  return places;
}

/// As [robots] places them.
std::vector<RobotPlace> places_of_all(const Experiment& experiment, const HeightField& terrain) {
  const RobotsSection& robots = experiment.robots;
  const RobotPlace centre{experiment.vehicle.x_m, experiment.vehicle.y_m,
                          experiment.vehicle.heading_deg};
  if (robots.count == 1) return {centre};
  if (robots.placement == "list") return places_in(robots.places).value();
  if (robots.placement == "ring") return ring(robots, centre);
  if (robots.placement == "random") return random_places(experiment, terrain);
  return grid(robots, centre);
}

}  // namespace

std::vector<RobotPlace> robot_places(const Experiment& experiment, const HeightField& terrain) {
  std::vector<RobotPlace> places = places_of_all(experiment, terrain);
  for (size_t i = 0; i < places.size(); ++i) {
    Experiment own = experiment;
    own.vehicle.x_m = places[i].x_m;
    own.vehicle.y_m = places[i].y_m;
    own.vehicle.heading_deg = places[i].heading_deg;
    apply_robot_section(own, i);
    places[i] = {own.vehicle.x_m, own.vehicle.y_m, own.vehicle.heading_deg};
  }
  return places;
}

// Traps as heights over the distance from the start.

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
