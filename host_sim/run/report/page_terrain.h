// The terrain of a run over time, small enough for a page: a coarse grid, heights in whole steps of
// a unit, and from one moment to the next only what has changed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host_sim/core/json.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/terrain/height_map.h"
#include "host_sim/render/report/page_file.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {

/// Heights in steps of unit_m above low_m.
struct HeightScaleOfPage {
  double low_m = 0.0;
  double unit_m = 0.0;
};

/// A grid of at most `max_side` nodes a side. Each of its nodes is the mean of a square of nodes of
/// the terrain, `merged` by `merged` of them.
struct CoarseGrid {
  static constexpr int kMaxSide = 240;

  explicit CoarseGrid(const HeightMapGeometry& geometry, int max_side = kMaxSide);
  std::size_t nodes() const { return x_m.size() * y_m.size(); }
  /// The field on this grid, in metres, row by row from the south. The field has the numbers of
  /// nodes of the geometry that the grid was made for.
  std::vector<double> heights_m(const HeightField& field) const;

  int merged;
  std::vector<double> x_m;  ///< of the columns, west to east
  std::vector<double> y_m;  ///< of the rows, south to north
};

/// What one moment changed: nodes in ascending order, and by how many units.
struct CoarseChange {
  std::uint32_t node;
  std::int32_t by;
};
using CoarseChanges = std::vector<CoarseChange>;

class HeightSteps {
 public:
  /// Starts from the field; later ones lie between the two heights (those beyond are cut off).
  HeightSteps(const CoarseGrid& grid, const HeightField& first, double low_m, double high_m);

  /// The next moment.
  void add(const HeightField& field);

  /// Joins each two moments into one until the packed and deflated changes take up to `max_bytes`.
  /// Returns how many moments are one now; 1 when nothing had to be joined.
  std::uint32_t fit(std::size_t max_bytes);

  const HeightScaleOfPage& scale() const { return scale_; }
  std::size_t steps() const { return steps_.size(); }
  /// The start: uint16, the first of a row as it is, the others as differences from their left
  /// neighbour, modulo 65536.
  std::vector<std::uint8_t> packed_start() const;
  /// Of each moment the number of changed nodes, and of each node how far it is from the one before
  /// (the first: from -1) and by how many units it rose, zigzag-coded; all of them LEB128.
  std::vector<std::uint8_t> packed_steps() const;

 private:
  std::vector<std::uint16_t> quantised(const HeightField& field) const;

  CoarseGrid grid_;
  HeightScaleOfPage scale_;
  std::vector<std::uint16_t> start_;
  std::vector<std::uint16_t> now_;
  std::vector<CoarseChanges> steps_;
};

// The terrain of a recorded run for its page: the maps over time, and figures of them.

/// Adds the blocks "terrain-start" and "terrain-steps" to the page, and "terrain-<curve>" of the
/// figures, and returns what the page needs to know of them; null when the session lacks the
/// terrain before the run. `stops`: rows of the session, ascending, at which the page can stop.
Json add_terrain(PageFile& page, const SessionReader& session, std::span<const std::uint64_t> stops,
                 const TaskProgress& progress);

}  // namespace screed
