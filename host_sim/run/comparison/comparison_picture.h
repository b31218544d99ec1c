// Two runs in one picture: paths on a map, the difference of their terrains, deviation and states
// over time, what differs in their configuration.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "host_sim/run/comparison/session_comparison.h"

namespace screed {

/// The value at which a diverging scale of heights ends, m: 1, 2 or 5 times a power of ten, at
/// least 0.1 mm, such that at most one height in 200 of those that are not 0 lies beyond.
double difference_limit_m(const std::vector<double>& height_m);

/// The text of an SVG file. `labels`: what the user calls the runs. Throws InputError when neither
/// run has a frame.
std::string comparison_svg(const SessionComparison& comparison,
                           const std::array<std::string, 2>& labels);

/// Writes it as a PNG. Throws as above, RunError when the file cannot be written.
void write_comparison_picture(const std::filesystem::path& path,
                              const SessionComparison& comparison,
                              const std::array<std::string, 2>& labels);

}  // namespace screed
