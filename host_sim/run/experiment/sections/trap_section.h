// [trap] of an experiment file: a place that the robot does not get out of, in front of its start.
#pragma once

#include <string>
#include <vector>

namespace screed {

/// The names of [trap] kind; the first is that of no trap (trap.cpp).
std::vector<std::string> trap_kinds();

struct TrapSection {
  std::string kind = "none";
  double distance_m = 0.5;
  double size = 0.1;  ///< m; of a slope degrees

  template <class Keys>
  static void list(Keys& keys) {
    using T = TrapSection;
    keys.choice("kind", trap_kinds(),
                "obstacle that robots get stuck at: a wall, a slope or a trench all round the "
                "start; a hump between the tracks, ruts under them, in front of it",
                &T::kind);
    const auto is_there = [](const T& trap) { return trap.kind != "none"; };
    keys.real("distance", "m", -10, 10,
              "distance from the start to the obstacle, 0.5 if left out; ruts may begin behind the "
              "start",
              &T::distance_m)
        .written_if(is_there);
    keys.real("size", "m or deg", 0.001, 60,
              "height or depth in m, 0.1 if left out; of a slope its angle in degrees", &T::size)
        .written_if(is_there);
  }
};

}  // namespace screed
