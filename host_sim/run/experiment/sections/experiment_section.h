// [experiment] of an experiment file: what runs, and for how long.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace screed {

inline constexpr uint32_t kMaxFrames = 8U * INT16_MAX;  // eight blocks of a parameter's range

/// The names of [experiment] algorithm.
std::vector<std::string> algorithm_names();

struct ExperimentSection {
  std::string name = "experiment";
  std::string algorithm = "hill_sensing";
  double duration_s = 60.0;
  std::optional<uint32_t> frames;      ///< in place of duration_s; always set for training_drive
  std::optional<double> stop_after_s;  ///< of the training drive
  uint64_t seed = 1;
  double flatness_deg = 5.0;  ///< epsilon of the thesis' flatness, as a slope
  std::optional<double> lay_on_side_at_s;

  template <class Keys>
  static void list(Keys& keys) {
    using E = ExperimentSection;
    keys.text("name", "letters, digits, _ and -; at most 64", "names the run folder", &E::name,
              [](const std::string& text) {
                return !text.empty() && text.size() <= 64 &&
                       text.find_first_not_of(
                           "abcdefghijklmnopqrstuvwxyz"
                           "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") == std::string::npos;
              });
    keys.choice(
        "algorithm", algorithm_names(),
        "what the firmware does; training_drive: the drive for training data (thesis Algorithm 5)",
        &E::algorithm);
    keys.real("duration", "s", 0.01, 1e6, "simulated time", &E::duration_s)
        .replaces([](E& experiment) { experiment.frames.reset(); })
        .written_if([](const E& experiment) { return !experiment.frames.has_value(); });
    keys.integer("frames", "0.01 s", 8, kMaxFrames,
                 "in place of duration; algorithm training_drive: the n of Algorithm 5", &E::frames,
                 8);
    keys.real("stop_after", "s", 0.01, 1e4,
              "algorithm training_drive: the run ends when the drive has lasted so long, whatever "
              "its n",
              &E::stop_after_s);
    keys.integer("seed", "", 0, UINT64_MAX, "seed of every random generator of the world",
                 &E::seed);
    keys.real("flatness", "deg", 0.0, 89, "slope up to which ground counts as flat",
              &E::flatness_deg);
    keys.real("lay_on_side_at", "s", 0.01, 1e6, "fault: the robot is laid on its side at this time",
              &E::lay_on_side_at_s);
  }
};

}  // namespace screed
