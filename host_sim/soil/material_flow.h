// Moves material over the grid in whole units, always as much up as down: sets sunk soil down,
// drags it, lets slopes slide.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/terrain/height_field.h"

namespace screed {

class MaterialFlow {
 public:
  MaterialFlow(HeightField surface, double repose_deg);

  const HeightField& surface() const { return surface_; }
  size_t nodes() const { return reference_.size(); }
  size_t index(int ix, int iy) const {
    return static_cast<size_t>(iy) * static_cast<size_t>(surface_.nx()) + static_cast<size_t>(ix);
  }
  /// The node at (ix, iy) with the field's wrap-around, or nothing (-1) outside a field without it.
  int64_t node_at(int ix, int iy) const;

  Height height(size_t node) const { return surface_.node(column(node), row(node)); }
  /// Level from which sinkage counts.
  Height reference(size_t node) const { return reference_[node]; }

  /// Pushes a node's surface down by `units`: they are in hand until set down. The reference stays:
  /// it is sinkage.
  void sink(size_t node, Height units);
  /// Takes `units` of sunk material out of hand: compacted.
  void take_from_hand(int64_t units) { in_hand_ -= units; }
  int64_t in_hand() const { return in_hand_; }
  /// Moves `units` from one node to another; the reference moves with the material.
  void move(size_t from, size_t to, Height units);
  /// A body stands on this node in the current step: nothing slides onto or off it.
  void cover(int ix, int iy);

  /// Sets what is in hand down, in equal parts, on the free neighbours of covered nodes; keeps it
  /// in hand when there are none.
  void set_down();
  /// Looks at every slope again, as on a bed that nobody has touched yet.
  void wake_all();
  /// Slides slopes above the angle of repose, at most `most` moves; returns the moves made.
  int64_t slide(int64_t most);
  /// Forgets which nodes are covered: the step is over.
  void uncover();

 private:
  int column(size_t node) const {
    return static_cast<int>(node % static_cast<size_t>(surface_.nx()));
  }
  int row(size_t node) const { return static_cast<int>(node / static_cast<size_t>(surface_.nx())); }
  void set_height(size_t node, Height height) {
    surface_.set_node(column(node), row(node), height);
  }
  void change(size_t node, Height units);
  void wake(size_t node);

  HeightField surface_;
  std::vector<Height> reference_;
  Height limit_straight_;  // greatest stable difference between neighbours
  Height limit_diagonal_;
  int64_t in_hand_ = 0;
  uint64_t turn_ = 0;  // where the remainder of a division goes first
  std::vector<uint8_t> covered_;
  std::vector<size_t> covered_list_;
  std::vector<size_t> ring_;
  std::vector<uint8_t> in_ring_;
  std::vector<uint8_t> awake_;
  std::vector<size_t> queue_;  // ring buffer of nodes whose slopes may be too steep
  size_t queue_begin_ = 0;
  size_t queue_size_ = 0;
};

}  // namespace screed
