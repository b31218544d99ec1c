// How level a bed is: at robot scale, by what was carried, as points over time.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "host_sim/core/record.h"
#include "host_sim/leveling/traversability.h"
#include "host_sim/physics/terrain/height_field.h"

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

// One row of a run's leveling curve: what the surface is like, what levelling it would still take,
// and what it has cost so far. docs/leveling-metrics.md defines every figure.
//
// The list is a macro so that the struct, the table of the session and the header of the CSV file
// are one thing. What was not measured at that moment is not a number.

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

// A surface as a robot feels it: what a Gaussian low-pass of half its width leaves is what it
// drives up and down, what the low-pass takes away is what its tracks roll over.

/// Standard deviation of the low-pass that parts relief from roughness: half the robot's width, m.
inline constexpr double kRobotScale_m = 0.05;

/// Root mean squares over the nodes of the heights above the mean plane (low_pass.h), and of the
/// low-passed surface with its plane the heights about their mean and the slopes.
struct RobotScaleFigures {
  double level_deviation_m =
      0.0;                   ///< U: of what a low-pass of kRobotScale_m leaves, with its plane
  double relief_m = 0.0;     ///< R: of what a low-pass of kRobotScale_m leaves
  double roughness_m = 0.0;  ///< Q: of what it takes away: ruts, ridges, single stones
  double flatness = 0.0;     ///< F: share of cells whose low-passed slope is within the limit, 0..1
};

/// flat_deg: the limit, 0..89. A slope that exceeds it by no more than gradient_rounding() counts
/// as within, as in flatness(). Throws InputError outside of the range.
RobotScaleFigures robot_scale_figures(const HeightField& field, double flat_deg);

// The least work that would still level a surface: optimal transport of the ground above its mean
// height into what lies below it.
//
// Ground that stands above the mean height has to go where ground is missing; a plan says how much
// goes from where to where. Of all plans the cheapest is found, on a grid of blocks:
//
//     T  = W1   = min sum m_ij d_ij     d_ij: distance in the plane, on wrapped terrain round its
//     edges T2 = W2^2 = min sum m_ij d_ij^2
//
// with m_ij >= 0, the sum over j equal to the excess of block i, that over i to the lack of block j
// (Kantorovich 1942; a minimum-cost flow).

/// Blocks along the longer side of a bed: 24 x 24 solve in some 20 ms.
inline constexpr int kTransportBlocks = 24;

/// A block of nodes, and the ground in it above the mean height.
struct GroundBlock {
  double x_m = 0.0;  ///< its centre
  double y_m = 0.0;
  double excess_m3 = 0.0;  ///< less than 0: missing
};

/// A surface on a coarse grid, each node standing for a cell of it.
struct GroundBlocks {
  std::vector<GroundBlock> blocks;
  double width_m = 0.0;  ///< of the bed
  double length_m = 0.0;
  bool wrap = false;
  /// The error of W1 by the coarse grid is at most this, m3 m: the work of carrying every node's
  /// excess to its block's centre (W1 is a norm of the excess, so the triangle inequality holds).
  double w1_error = 0.0;
};

/// blocks: along the longer side, 1 or more, of equal size but for one node; at most one a node.
/// Throws InputError for less than 1.
GroundBlocks ground_blocks(const HeightField& surface, int blocks = kTransportBlocks);

/// W1 of the blocks, m3 m. The same blocks give the same bits: the problem is solved in integers,
/// of 2^-40 of the volume and 2^-30 of the bed's size.
double least_transport(const GroundBlocks& ground);
/// W2^2, m3 m2, likewise.
double least_squared_transport(const GroundBlocks& ground);

// Measures how level a surface is and what it has cost, relative to the surface at the start.

/// The robot's share of a point.
struct LevelingCost {
  double time_s = 0.0;
  double distance_m = 0.0;
  double energy_j = 0.0;
  Traversability traversability;
};

class LevelingMeter {
 public:
  /// flat_deg: slope up to which a cell is flat, at both scales, 0..89.
  explicit LevelingMeter(double flat_deg) : flat_deg_(flat_deg) {}

  /// with_transport: the four figures of optimal transport as well, some 15 ms. Those of the first
  /// surface that is measured with them are the start, from which progress counts; on a level start
  /// progress is not a number.
  LevelingPoint measure(const HeightField& surface, const LevelingCost& cost, bool with_transport);
  /// A point without transport of a surface that is as it was when `earlier` was measured.
  static LevelingPoint unchanged(const LevelingPoint& earlier, const LevelingCost& cost);

 private:
  void add_transport(const HeightField& surface, LevelingPoint& point);

  double flat_deg_;
  std::optional<double> start_;  ///< transport at the start, m3 m
};

}  // namespace screed
