// [relief] of an experiment file: made-up relief on top of [map], for leveling.
#pragma once

#include <cstdint>
#include <optional>

#include "host_sim/physics/terrain/relief.h"

namespace screed {

struct ReliefSection {
  std::optional<uint64_t> seed;  ///< left out: the experiment's
  ReliefOptions options;

  bool is_there() const {
    return options.rms_m > 0.0 || options.mounds > 0 || options.trench_depth_m > 0.0;
  }

  template <class Keys>
  static void list(Keys& keys) {
    using R = ReliefSection;
    const auto spectrum = [](const R& relief) { return relief.options.rms_m > 0.0; };
    const auto mounds = [](const R& relief) { return relief.options.mounds > 0; };
    const auto trench = [](const R& relief) { return relief.options.trench_depth_m > 0.0; };
    keys.integer("seed", "", 0, UINT32_MAX,
                 "of waves and places; left out: [experiment] seed, another bed a seed", &R::seed);
    keys.real("rms", "m", 0, 10, "waves: RMS of their heights; 0: none",
              [](R& relief) -> double& { return relief.options.rms_m; })
        .written_if(spectrum);
    keys.real("exponent", "", 0, 4,
              "waves: power spectral density of a profile falls with wave number to the power of "
              "minus this",
              [](R& relief) -> double& { return relief.options.exponent; })
        .written_if(spectrum);
    keys.real("longest_wave", "m", 0.01, 1000, "waves: the longest; none is longer than the bed",
              [](R& relief) -> double& { return relief.options.longest_wave_m; })
        .written_if(spectrum);
    keys.real("shortest_wave", "m", 0.01, 1000, "waves: the shortest",
              [](R& relief) -> double& { return relief.options.shortest_wave_m; })
        .written_if(spectrum);
    keys.integer("mounds", "", 0, 1000, "cones at random places, as of a loose deposit",
                 [](R& relief) -> uint32_t& { return relief.options.mounds; })
        .written_if(mounds);
    keys.real("mound_height", "m", 0.001, 10, "the highest mound; the lowest is half as high",
              [](R& relief) -> double& { return relief.options.mound_height_m; })
        .written_if(mounds);
    keys.real("mound_slope", "deg", 1, 60, "slope of the mounds' flanks",
              [](R& relief) -> double& { return relief.options.mound_slope_deg; })
        .written_if(mounds);
    keys.real("trench_depth", "m", 0, 10,
              "a straight trench across the bed, banks of what was dug out on both sides; 0: none",
              [](R& relief) -> double& { return relief.options.trench_depth_m; })
        .written_if(trench);
    keys.real("trench_width", "m", 0.001, 100, "width of the trench's floor",
              [](R& relief) -> double& { return relief.options.trench_width_m; })
        .written_if(trench);
    keys.real("trench_slope", "deg", 1, 60, "slope of the flanks of trench and banks",
              [](R& relief) -> double& { return relief.options.trench_slope_deg; })
        .written_if(trench);
  }
};

}  // namespace screed
