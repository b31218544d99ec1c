// Grid, ring, random places, and those of a list.
#include "host_sim/run/world/robot_placement.h"

#include <cmath>
#include <numbers>
#include <string>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
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

}  // namespace screed
