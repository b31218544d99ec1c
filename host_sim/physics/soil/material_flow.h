// Moves material over the grid in whole units, always as much up as down: deposits sunk soil,
// drags it, lets slopes slide.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"

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

  const HeightField& surface() const { return surface_; }
  size_t nodes() const { return sunk_.size(); }
  size_t index(int ix, int iy) const {
    return static_cast<size_t>(iy) * static_cast<size_t>(surface_.nx()) + static_cast<size_t>(ix);
  }
  /// The node at (ix, iy) with the field's wrap-around, or nothing (-1) outside a field without it.
  int64_t node_at(int ix, int iy) const {
    return on_field(ix, iy) || surface_.wrap() ? static_cast<int64_t>(node_on(ix, iy)) : -1;
  }
  /// The same of a place on the field or of a field with wrap-around: not checked.
  size_t node_on(int ix, int iy) const {
    if (on_field(ix, iy)) return index(ix, iy);
    const int nx = surface_.nx();
    const int ny = surface_.ny();
    return index(((ix % nx) + nx) % nx, ((iy % ny) + ny) % ny);
  }

  /// A part of a row of the grid, [first_ix, end_ix), of places as node_on() takes them, in runs of
  /// nodes that follow each other: calls run(first node, its ix, length).
  template <typename Run>
  void each_run(int iy, int first_ix, int end_ix, const Run& run) const {
    for (int ix = first_ix; ix < end_ix;) {
      const size_t node = node_on(ix, iy);
      const int left_in_row = surface_.nx() - column(node);
      const int length = end_ix - ix < left_in_row ? end_ix - ix : left_in_row;
      run(node, ix, static_cast<size_t>(length));
      ix += length;
    }
  }

  Height height(size_t node) const { return surface_.node(node); }
  /// How far a node has been pressed down, units: what is deposited on it takes from that, what
  /// slides or is dug away leaves it as it is.
  Height sunk(size_t node) const { return sunk_[node]; }
  /// Level from which sinkage counts.
  Height reference(size_t node) const { return height(node) + sunk_[node]; }

  /// Before the first step: the node has been pressed down by so many units.
  void begin_sunk(size_t node, Height units) {
    if (units == 0) return;
    set_height(node, height(node) - units);
    sunk_[node] += units;
    enqueue(node);
  }
  /// Begins a footprint: what cover() and sink() say until the next call is about it. Comes before
  /// them.
  void begin_footprint(const PressedPatch& patch = {});
  /// The footprint stands on this node: nothing slides onto or off it. `ix` and `iy` without
  /// wrap-around.
  void cover(size_t node, int ix, int iy) {
    if ((flags_[node] & kCovered) != 0) return;
    flags_[node] |= kCovered;
    covered_list_.push_back({node, ix, iy});
  }
  /// The footprint pushes a node's surface down by `units`: those that are not compacted are in
  /// transit until deposited beside it. The reference stays: it is sinkage. `ix` and `iy` without
  /// wrap-around.
  void sink(size_t node, int ix, int iy, Height units) {
    const Height lower = height(node) - units;
    if (on_field(ix, iy)) {  // quicker than finding column and row by division
      surface_.set_node(ix, iy, lower);
    } else {
      set_height(node, lower);
    }
    sunk_[node] += units;
    const Height moved = units - compact(node, units);
    in_transit_ += moved;
    footprints_.back().units += moved;
    pressed_.push_back({ix, iy, moved});
    enqueue(node);
  }
  int64_t in_transit() const { return in_transit_; }
  /// What has got denser, units.
  int64_t compacted() const { return compacted_; }
  /// Deposits what is in transit on the free neighbours of each footprint's nodes, most of it
  /// beside the place where it was pressed down (PressedPatch::reach); those behind the footprint
  /// are left out: there lies the rut. Keeps it in transit when there are none.
  void deposit();

  /// The footprint whose dig() comes next slips over this node; weights are relative.
  void shear(size_t node, double weight) { sheared_.push_back({node, weight}); }
  /// Takes `units` from the nodes given to shear() since the last call, in proportion to their
  /// weights; the reference goes down with the surface. Those that are not compacted are in transit
  /// until they are deposited around the patch, more of them to where something is carried than to
  /// where it comes from. Takes nothing without sheared nodes.
  void dig(const DugPatch& patch, int64_t units);
  /// Queues every node: slide() then checks the whole bed. A new bed starts with an empty queue.
  void enqueue_all();
  /// Slides slopes above the angle of repose, at most `max_moves` moves; returns the moves made.
  int64_t slide(int64_t max_moves);
  /// Whether the slopes round a node are still to be looked at: it waits in the queue, or a body
  /// stood on it in the last step.
  bool is_queued(size_t node) const { return (flags_[node] & (kQueued | kHeld)) != 0; }
  size_t queued() const { return queue_size_; }
  /// Forgets which nodes are covered: the step is over.
  void uncover();

 private:
  bool on_field(int ix, int iy) const {
    return ix >= 0 && iy >= 0 && ix < surface_.nx() && iy < surface_.ny();
  }
  int column(size_t node) const {
    return static_cast<int>(static_cast<uint32_t>(node) % static_cast<uint32_t>(surface_.nx()));
  }
  int row(size_t node) const {
    return static_cast<int>(static_cast<uint32_t>(node) / static_cast<uint32_t>(surface_.nx()));
  }
  void set_height(size_t node, Height height) {
    surface_.set_node(column(node), row(node), height);
  }
  struct GridNode {
    size_t node;
    int ix;
    int iy;
  };
  void change(size_t node, Height units) { change({node, column(node), row(node)}, units); }
  /// Lays so many units on a node, or takes them. What is taken leaves the rest as pressed as it
  /// was: the reference goes down with the surface. What is laid down is loose: it fills a rut up
  /// to its reference first, and raises both from there on.
  void change(const GridNode& place, Height units);
  /// Of so many units that a node loses, those that get denser there: they are booked.
  Height compact(size_t node, Height units) {
    if (compaction_.share <= 0.0) return 0;
    remainder_ += compaction_.share * units;
    auto denser = std::min(units, static_cast<Height>(remainder_));
    remainder_ -= denser;
    if (!loose_.empty()) {
      denser = std::min(denser, loose_[node]);
      loose_[node] -= denser;
    }
    compacted_ += denser;
    return denser;
  }
  /// A covered node comes into the queue when the body has left it.
  void enqueue(size_t node) {
    if ((flags_[node] & (kQueued | kCovered | kHeld)) == 0) push(node);
  }
  void push(size_t node) {
    flags_[node] |= kQueued;
    size_t end = queue_begin_ + queue_size_;
    if (end >= queue_.size()) end -= queue_.size();
    queue_[end] = static_cast<uint32_t>(node);
    ++queue_size_;
  }

  enum Flag : uint8_t {
    kCovered = 1,  // in this step
    kHeld = 2,     // in the last step
    kQueued = 4,
    kBorder = 8,  // its neighbours are not all beside it in memory, or nothing follows them there
  };
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
  void drop_rut(const ActiveFootprint& footprint, size_t end);
  void weigh_ring(const ActiveFootprint& footprint, size_t end_pressed);
  bool spread(const ActiveFootprint& footprint, size_t end, size_t end_pressed);
  void release_held();
  bool may_slide(size_t node) const;
  int64_t slide_around(const GridNode& place);
  int64_t spread_dug(const Dug& dug);

  HeightField surface_;
  std::vector<Height> sunk_;
  Compaction compaction_;
  std::vector<Height> loose_;  // what a node may still lose by compaction; none: anything
  double remainder_ = 0.0;     // parts of a unit, for what is compacted next
  int64_t compacted_ = 0;
  Height limit_straight_;  // greatest stable difference between neighbours
  Height limit_diagonal_;
  int64_t in_transit_ = 0;
  uint64_t turn_ = 0;  // where the remainder of a division goes first
  std::vector<uint8_t> flags_;
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
  uint32_t sequence_index_ = 0;  // of the next point to try for what was dug, minus 1
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
