// Moves material over the grid in whole units, always as much up as down: deposits sunk soil,
// drags it, lets slopes slide.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "host_sim/physics/soil/soil_grid.h"
#include "host_sim/physics/terrain/terrain.h"

namespace screed {

/// The rectangle that a footprint touches, seen from above.
struct DugPatch {
  Eigen::Vector2d centre;
  Eigen::Vector2d forward;  ///< unit length
  double half_length;       ///< m
  double half_width;        ///< m
  double band;              ///< what is dug is deposited as far as this around it, m
  /// What goes past it from one side to the other: amount times way, units times m.
  Eigen::Vector2d carried = Eigen::Vector2d::Zero();
};

/// What presses the ground down in one step, seen from above.
struct PressedPatch {
  /// m/s; below 1 mm/s it stands and leaves no rut behind it.
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  Eigen::Vector2d forward = Eigen::Vector2d::UnitX();  ///< its longer side, unit length
  /// Along that side, what is pressed down is laid beside the patch with exp(-distance / reach), m;
  /// taken as a spacing where it is less.
  double reach = std::numeric_limits<double>::infinity();
};

/// What becomes of material that is pressed down or dug away: a share of it gets denser where it
/// was, until the ground there can get no denser.
struct Compaction {
  double share = 0.0;   ///< 0..1
  double most_m = 0.0;  ///< what a place may lose in all; 0: anything
};

class MaterialFlow {
 public:
  MaterialFlow(HeightField surface, double repose_deg, const Compaction& compaction = {});

  const SoilGrid& grid() const { return grid_; }
  SoilGrid& grid() { return grid_; }
  /// Begins a footprint: what cover() and sink() say until the next call is about it. Comes before
  /// them.
  void begin_footprint(const PressedPatch& patch = {});
  /// The footprint stands on this node: nothing slides onto or off it.
  void cover(const GridNode& place) {
    if (grid_[place.node].covered) return;
    grid_[place.node].covered = true;
    covered_list_.push_back(place);
  }
  /// The footprint pushes a node's surface down by `units`: those that are not compacted are in
  /// transit until deposited beside it. The reference stays: it is sinkage.
  void sink(const GridNode& place, Height units) {
    grid_.set_height(place, grid_.height(place.node) - units);
    SoilCell& cell = grid_[place.node];
    cell.sunk += units;
    const Height moved = units - compact(cell, units);
    in_transit_ += moved;
    footprints_.back().units += moved;
    pressed_.push_back({place.ix, place.iy, moved});
    enqueue(place.node);
  }
  int64_t in_transit() const { return in_transit_; }
  /// What has got denser, units.
  int64_t compacted() const { return compacted_; }
  VolumeBalance balance() const {
    return {volume_before_, grid_.surface().height_sum(), compacted_, in_transit_};
  }
  /// Deposits what is in transit on the free neighbours of each footprint's nodes, most of it
  /// beside the place where it was pressed down (PressedPatch::reach); those behind and ahead of a
  /// footprint that moves are left out. Keeps it in transit when there are none.
  void deposit();

  /// The footprint whose dig() comes next slips over this node; weights are relative.
  void shear(size_t node, double weight) { sheared_.push_back({node, weight}); }
  /// Takes `units` from the nodes given to shear() since the last call, in proportion to their
  /// weights (none without such nodes); the reference goes down with the surface. Those that are
  /// not compacted, and this share of what the current footprint has pressed down, are in transit
  /// until they are deposited around the patch, more of them to where something is carried than to
  /// where it comes from.
  void dig(const DugPatch& patch, int64_t units, double share_of_pressed = 0.0);
  /// Queues every node: slide() then checks the whole bed. A new bed starts with an empty queue.
  void enqueue_all();
  /// Slides slopes above the angle of repose, at most `max_moves` moves; returns the moves made.
  int64_t slide(int64_t max_moves);
  /// Whether the slopes round a node are still to be looked at: it waits in the queue, or a body
  /// stood on it in the last step.
  bool is_queued(size_t node) const { return grid_[node].queued || grid_[node].held; }
  size_t queued() const { return queue_size_; }
  /// Forgets which nodes are covered: the step is over.
  void uncover();
  /// What is kept from step to step, but the heights.
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(grid_, volume_before_, remainder_, compacted_, in_transit_, turn_, held_list_,
            left_over_, taken_remainder_, sequence_index_, queue_, queue_begin_, queue_size_);
  }

 private:
  /// Lays so many units on a node, or takes them. What is taken leaves the rest as pressed as it
  /// was: the reference goes down with the surface. What is laid down is loose: it fills a rut up
  /// to its reference first, and raises both from there on.
  void change(const GridNode& place, Height units);
  /// Of so many units that a cell loses, those that get denser there: they are booked.
  Height compact(SoilCell& cell, Height units) {
    if (compaction_.share <= 0.0) return 0;
    remainder_ += compaction_.share * units;
    auto denser = std::min(units, static_cast<Height>(remainder_));
    remainder_ -= denser;
    denser = std::min(denser, cell.loose);
    cell.loose -= denser;
    compacted_ += denser;
    return denser;
  }
  /// A covered node comes into the queue when the body has left it.
  void enqueue(size_t node) {
    const SoilCell& cell = grid_[node];
    if (!cell.queued && !cell.covered && !cell.held) push(node);
  }
  void push(size_t node) {
    grid_[node].queued = true;
    size_t end = queue_begin_ + queue_size_;
    if (end >= queue_.size()) end -= queue_.size();
    queue_[end] = static_cast<uint32_t>(node);
    ++queue_size_;
  }

  struct ActiveFootprint {  // a footprint in this step
    PressedPatch patch;
    size_t begin;          // of its nodes among covered_list_
    size_t begin_pressed;  // among pressed_
    int64_t units;         // in transit
  };
  struct Pressed {
    int ix;
    int iy;
    Height units;  // in transit
  };
  struct Dug {  // to be deposited around it
    DugPatch patch;
    int64_t units;
  };
  void find_ring(size_t begin, size_t end);
  void drop_path(const ActiveFootprint& footprint, size_t end);
  void weigh_ring(const ActiveFootprint& footprint, size_t end_pressed);
  bool spread(const ActiveFootprint& footprint, size_t end, size_t end_pressed);
  void release_held();
  bool may_slide(size_t node) const;
  int64_t slide_around(const GridNode& place);
  int64_t spread_dug(const Dug& dug);

  SoilGrid grid_;
  int64_t volume_before_;
  Compaction compaction_;
  double remainder_ = 0.0;  // parts of a unit, for what is compacted next
  int64_t compacted_ = 0;
  Height limit_straight_;  // greatest stable difference between neighbours
  Height limit_diagonal_;
  int64_t in_transit_ = 0;
  uint64_t turn_ = 0;  // where the remainder of a division goes first
  std::vector<GridNode> covered_list_;
  std::vector<GridNode> held_list_;
  std::vector<ActiveFootprint> footprints_;
  std::vector<Pressed> pressed_;
  int64_t left_over_ = 0;  // in transit from earlier steps
  struct Sheared {
    size_t node;
    double weight;
  };
  std::vector<Sheared> sheared_;  // by the current footprint
  std::vector<Dug> dug_;
  double taken_remainder_ = 0.0;  // parts of a unit, of what was pressed
  uint32_t sequence_index_ = 0;   // of the next point to try for what was dug, minus 1
  struct DepositNode {
    GridNode place;
    double along;  // from the patch's centre, m
    double across;
  };
  std::vector<DepositNode> deposit_nodes_;
  struct RingNode {
    GridNode place;
    double along;  // spacings
    double share;  // of what the footprint lays down
  };
  std::vector<RingNode> ring_;
  // By slices of a spacing along a footprint.
  std::vector<double> nearby_;  // how much of the ring is near
  std::vector<double> laid_;    // units laid down on each node of the ring
  std::vector<double> smoothed_;
  std::vector<uint64_t> below_bits_;  // a footprint's nodes seen from above, a bit each
  std::vector<uint32_t> queue_;       // ring buffer of nodes whose slopes may be too steep
  size_t queue_begin_ = 0;
  size_t queue_size_ = 0;
};

}  // namespace screed
