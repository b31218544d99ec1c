// One row of a run's leveling curve: what the surface is like, what levelling it would still take,
// and what it has cost so far. docs/leveling-metrics.md defines every figure.
//
// The list is a macro so that the struct, the table of the session and the header of the CSV file
// are one thing. What was not measured at that moment is not a number.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "host_sim/core/record.h"

// clang-format off
//  name                  unit        meaning
#define SCREED_LEVELING_COLUMNS(X) \
  X(time,                 "s",        "simulated time") \
  X(level_deviation,            "m",        "U: RMS of the heights about level, after a Gaussian low-pass of 50 mm") \
  X(relief,               "m", \
    "R: RMS of the heights above their mean plane, after a Gaussian low-pass of 50 mm") \
  X(roughness,            "m",        "Q: RMS of what the low-pass takes away") \
  X(robot_scale_flatness, "1",        "F: share of cells whose slope after the low-pass is within the limit") \
  X(flatness,             "1",        "share of cells whose slope is within the limit (thesis 4.1)") \
  X(height_deviation,     "m",        "standard deviation of the heights") \
  X(transport,            "m3 m",     "T: least volume times distance that levels the surface (W1)") \
  X(transport_error,      "m3 m",     "the most by which the coarse grid can change transport") \
  X(transport_squared,    "m3 m2",    "least volume times squared distance (square of W2)") \
  X(progress,             "1",        "1 - transport / transport at the start") \
  X(transport_per_joule,  "m3 m/J",   "transport saved since the start, per energy") \
  X(distance,             "m",        "path of the chassis since the start") \
  X(energy,               "J",        "energy drawn from the battery since the start") \
  X(slip,                 "1",        "mean magnitude of the tracks' slip while they run") \
  X(stuck,                "1",        "share of the time so far in which the tracks ran and the robot did not travel") \
  X(tilted,               "1",        "share of the time so far with the chassis inclined past tilt_limit") \
  X(off_site,             "1",        "share of the time so far outside site_radius or beyond the edge of the bed") \
  X(returning,            "1",        "share of the time so far in which the algorithm drove back to its site") \
  X(visited,              "1",        "share of the site that the robot has come over so far")
// clang-format on

namespace screed {

struct LevelingPoint {
#define SCREED_LEVELING_FIELD(name, unit, meaning) \
  double name = std::numeric_limits<double>::quiet_NaN();
  SCREED_LEVELING_COLUMNS(SCREED_LEVELING_FIELD)
#undef SCREED_LEVELING_FIELD
};

inline constexpr auto kLevelingColumns = record_detail::with_offsets(std::to_array<Column>({
#define SCREED_LEVELING_COLUMN(name, unit, meaning) \
  record_detail::make_column<decltype(LevelingPoint::name)>(#name, unit, meaning),
    SCREED_LEVELING_COLUMNS(SCREED_LEVELING_COLUMN)
#undef SCREED_LEVELING_COLUMN
}));

/// A row as bytes is the struct itself.
inline constexpr std::size_t kLevelingBytes = row_bytes(kLevelingColumns);
static_assert(sizeof(LevelingPoint) == kLevelingBytes);

}  // namespace screed
