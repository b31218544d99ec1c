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

  Height height(size_t node) const { return surface_.node(node); }
  /// Level from which sinkage counts.
  Height reference(size_t node) const { return reference_[node]; }

  /// A body's footprint that moves in the direction (x, y), any length, in the current step; what
  /// follows until the next one is its. Returns its number.
  size_t begin_footprint(double way_x, double way_y);
  /// It stands on this node: nothing slides onto or off it. `ix` and `iy` without wrap-around.
  void cover(size_t node, int ix, int iy);
  /// Pushes a node's surface down by `units`: they are in hand until set down. The reference stays:
  /// it is sinkage.
  void sink(size_t node, Height units);
  /// Tells how much a footprint has sunk in this step.
  void push(size_t footprint, int64_t units) { footprints_[footprint].units += units; }
  int64_t in_hand() const { return in_hand_; }
  /// Takes `units` of sunk material out of hand, at most all: it stays where it is, denser.
  void compact(int64_t units);
  /// Sets what is in hand down, in equal parts, on the free neighbours of each footprint's nodes,
  /// those behind it left out: there lies the rut. Keeps it in hand when there are none.
  void set_down();

  /// Moves `units` from one node to another; the reference moves with the material.
  void move(size_t from, size_t to, Height units);
  /// Looks at every slope again, as on a bed that nobody has touched yet.
  void wake_all();
  /// Slides slopes above the angle of repose, at most `most` moves; returns the moves made.
  int64_t slide(int64_t most);
  /// Forgets which nodes are covered: the step is over.
  void uncover();

 private:
  int column(size_t node) const {
    return static_cast<int>(static_cast<uint32_t>(node) % static_cast<uint32_t>(surface_.nx()));
  }
  int row(size_t node) const {
    return static_cast<int>(static_cast<uint32_t>(node) / static_cast<uint32_t>(surface_.nx()));
  }
  void set_height(size_t node, Height height) {
    surface_.set_node(column(node), row(node), height);
  }
  void change(size_t node, Height units);
  void wake(size_t node);

  struct Place {
    size_t node;
    int ix;
    int iy;
  };
  struct Pressing {  // a footprint in this step
    size_t begin;    // of its nodes among covered_list_
    double way_x;    // unit length, or 0
    double way_y;
    int64_t units;  // in hand
  };
  int64_t spread(const Pressing& footprint, size_t end);

  HeightField surface_;
  std::vector<Height> reference_;
  Height limit_straight_;  // greatest stable difference between neighbours
  Height limit_diagonal_;
  int64_t in_hand_ = 0;
  uint64_t turn_ = 0;  // where the remainder of a division goes first
  std::vector<uint8_t> covered_;
  std::vector<Place> covered_list_;
  std::vector<Pressing> footprints_;
  int64_t left_over_ = 0;  // in hand from earlier steps
  std::vector<Place> ring_;
  std::vector<uint8_t> in_ring_;
  std::vector<uint8_t> awake_;
  std::vector<size_t> queue_;  // ring buffer of nodes whose slopes may be too steep
  size_t queue_begin_ = 0;
  size_t queue_size_ = 0;
};

}  // namespace screed
