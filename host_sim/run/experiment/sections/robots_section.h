// [robots] of an experiment file: how many share the bed, and where they start.
#pragma once

#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/finite_number.h"

namespace screed {

inline constexpr uint64_t kMaxRobots = 64;

/// Where a robot starts.
struct RobotPlace {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_deg = 0.0;
};

/// "x y heading" of each robot, separated by commas; nothing when it does not read like that.
inline std::optional<std::vector<RobotPlace>> places_in(const std::string& text) {
  constexpr double kFurthest_m = 500.0;
  constexpr double kTurn_deg = 360.0;
  std::vector<RobotPlace> places;
  std::istringstream list(text);
  for (std::string one; std::getline(list, one, ',');) {
    std::istringstream words(one);
    std::vector<double> numbers;
    for (std::string word; words >> word;) {
      const std::optional<double> number = finite_number<double>(word);
      if (!number.has_value()) return std::nullopt;
      numbers.push_back(*number);
    }
    if (numbers.size() != 3) return std::nullopt;
    for (const size_t axis : {0U, 1U}) {
      if (numbers[axis] < -kFurthest_m || numbers[axis] > kFurthest_m) return std::nullopt;
    }
    if (numbers[2] < -kTurn_deg || numbers[2] > kTurn_deg) return std::nullopt;
    places.push_back({numbers[0], numbers[1], numbers[2]});
  }
  if (places.empty()) return std::nullopt;
  return places;
}

struct RobotsSection {
  uint32_t count = 1;
  std::string placement = "grid";
  double spacing_m = 0.5;
  std::string places;  ///< as places_in() reads it
  double friction = 0.5;

  template <class Keys>
  static void list(Keys& keys) {
    using R = RobotsSection;
    keys.integer("count", "", 1, kMaxRobots, "robots on the bed, each with a ground station",
                 &R::count)
        .default_not_written();
    keys.choice("placement", {"grid", "ring", "random", "list"},
                "where several robots start: grid and ring round [vehicle] x, y; random by the "
                "seed; list: [robots] places",
                &R::placement)
        .default_not_written();
    keys.real("spacing", "m", 0.05, 100,
              "grid and ring: distance of neighbours; random: least distance of two robots",
              &R::spacing_m)
        .default_not_written();
    keys.text("places", "x y heading of each robot (m m deg), separated by commas",
              "placement list: where each robot starts", &R::places,
              [](const std::string& text) { return places_in(text).has_value(); });
    keys.real("friction", "", 0.0, 5, "Coulomb friction between robots", &R::friction)
        .default_not_written();
  }
};

}  // namespace screed
