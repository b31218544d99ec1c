// A grid of soil: everything that is kept of a cell, the history of its contacts included.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "host_sim/physics/kernels/kernels.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

// What a cell of soil remembers of the body on it: how its plastic sinkage is divided between the
// part below the body and the rest. The heights of the grid know the sum alone. One history a cell:
// when two bodies cover it in one step, the second replaces the share of the first.
//
// A body covers a share of a cell, and that share changes while it moves. With
//   sunk             S   plastic sinkage of the cell, a mean over it, m (from its integer heights)
//   covered          c   share of the cell below the body now, 0..1
//   covered_before   b   the same a step ago
//   beside           B   plastic sinkage of the part beside the body, times its share, m
//   under            u   plastic sinkage of the part below the body, m
//   old_sinkage      o   what of u was there before this contact began: reloading starts there, m
// the sum stays, whatever the body covers:
//   S = c u + B                                                                        (1)
// so u needs no memory. What the body leaves takes u along, what it reaches has the mean of the
// part beside it, r = mean_beside = B / (1 - b):
//   c < b:  u' = (S - B) / b,          B' = S - c u',        o' = o                    (2)
//   c > b:  B' = B - (c - b) r,        o' = (b o + (c - b) r) / c                      (3)
// In (3) c o' + B' = b o + B: what was there before the contact is kept as well. A new contact
// knows no parts: assume that the old sinkage lies below this body, over the larger of both shares.
//   new:    o' = S / max(c, b),        B' = S - c o'                                   (4)

/// A cell's plastic sinkage before this contact and beside the body, as (2) to (4) give it.
struct SinkageDivision {
  double old_sinkage;  ///< of the part below the body, before this contact, m
  double beside;       ///< of the part beside it, times its share, m
  /// Of the part below the body now, m; by (1). covered > 0.
  double under(double covered, double sunk) const { return (sunk - beside) / covered; }
};

class CellHistory {
 public:
  /// Whether a body that stands on the cell in step `now` was not there in the step before.
  bool is_contact_new(uint32_t now) const { return now - step_ > 1; }

  /// The division once the body covers `covered`, 0..1, in step `now`, of a cell that has sunk by
  /// `sunk`, m. Changes nothing.
  SinkageDivision divide(double covered, double sunk, uint32_t now) const {
    const auto covered_before = static_cast<double>(covered_);
    SinkageDivision part{static_cast<double>(old_sinkage_), static_cast<double>(beside_)};
    if (is_contact_new(now)) {
      part.old_sinkage = sunk / std::max({covered, covered_before, kMinCoveredShare});
      part.beside = sunk - covered * part.old_sinkage;
    } else if (covered < covered_before) {
      part.beside = sunk - covered * (sunk - part.beside) / covered_before;
    } else if (covered > covered_before) {
      const double mean_beside = covered_before < 1.0 ? part.beside / (1.0 - covered_before) : 0.0;
      part.old_sinkage =
          (covered_before * part.old_sinkage + (covered - covered_before) * mean_beside) / covered;
      part.beside -= (covered - covered_before) * mean_beside;
    }
    return part;
  }
  /// As kept last.
  double covered() const { return static_cast<double>(covered_); }
  double old_sinkage() const { return static_cast<double>(old_sinkage_); }
  double beside() const { return static_cast<double>(beside_); }
  /// Keeps a division and the share that it is of.
  void keep(double covered, const SinkageDivision& part) {
    covered_ = static_cast<float>(covered);
    old_sinkage_ = static_cast<float>(part.old_sinkage);
    beside_ = static_cast<float>(part.beside);
  }
  /// The body presses on the cell in step `now`, counted from 1.
  void touch(uint32_t now) { step_ = now; }
  /// It does not: the next contact is a new one, and finds what this one left.
  void release() { step_ = kNever; }
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(step_, covered_, old_sinkage_, beside_);
  }

 private:
  static constexpr uint32_t kNever = 1U << 31U;  // right for 2^31 steps, 24 days at 1 ms
  uint32_t step_ = kNever;  // of the last contact; kNever: there is none to go on with
  float covered_ = 0.0F;
  float old_sinkage_ = 0.0F;
  float beside_ = 0.0F;
};

// Deformable soil as a grid of cells: all that is kept of a cell, and where on the grid it lies. A
// node of the height field stands for the cell around it. What happens to cells is elsewhere:
// SoilBed and the stand-in's BeltGround press on them, MaterialFlow moves what they hold.
//
// A cell has two levels: its height, the surface as it lies there unloaded, and its reference, from
// which Bekker's sinkage counts; their difference is the plastic sinkage. Material that moves
// changes heights in pairwise opposite amounts, so that the volume is exact; material that is
// compacted is booked.

/// A cell of soil, but for the height of its surface, which stands in a HeightField.
struct SoilCell {
  /// How far the cell has been pressed down, units: what is deposited on it takes from that, what
  /// slides or is dug away leaves it as it is.
  Height sunk = 0;
  Height loose;            ///< what it may still lose by compaction, units
  CellHistory history{};   ///< of the body on it
  bool covered = false;    ///< by a body, in this step: nothing slides onto or off it
  bool held = false;       ///< by a body, in the last step
  bool queued = false;     ///< the slopes round it are to be looked at
  bool at_border = false;  ///< its neighbours are not all beside it in memory, or nothing follows

  /// What changes, but `covered`: no body is on it between two steps.
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(sunk, loose, history, held, queued);
  }
};

/// A cell by its number and its place; of a field with wrap-around the place may be outside.
struct GridNode {
  size_t node;
  int ix;
  int iy;
  /// Further along in the same row; not across the seam.
  GridNode eastward(size_t cells) const { return {node + cells, ix + static_cast<int>(cells), iy}; }
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(node, ix, iy);
  }
};

class SoilGrid {
 public:
  /// Each cell may lose `loose` units by compaction.
  SoilGrid(HeightField surface, Height loose)
      : surface_(std::move(surface)),
        cells_(static_cast<size_t>(surface_.nx()) * static_cast<size_t>(surface_.ny()),
               SoilCell{.loose = loose}) {
    const int nx = surface_.nx();
    const int ny = surface_.ny();
    const auto mark = [&](int ix, int iy) { cells_[node(ix, iy)].at_border = true; };
    for (int ix = 0; ix < nx; ++ix) mark(ix, 0), mark(ix, ny - 1);
    for (int iy = 0; iy < ny; ++iy) mark(0, iy), mark(nx - 1, iy);
    mark(nx - 2, ny - 2);
  }

  const HeightField& surface() const { return surface_; }
  size_t size() const { return cells_.size(); }
  SoilCell& operator[](size_t node) { return cells_[node]; }
  const SoilCell& operator[](size_t node) const { return cells_[node]; }
  Height height(size_t node) const { return surface_.node(node); }
  /// Level from which sinkage counts.
  Height reference(size_t node) const { return height(node) + cells_[node].sunk; }
  void set_height(const GridNode& at, Height height) {
    // Quicker than always finding column and row by division.
    const GridNode within = on_field(at.ix, at.iy) ? at : place(at.node);
    surface_.set_node(within.ix, within.iy, height);
  }

  /// The number of the cell at a place on the field or of a field with wrap-around: not checked.
  size_t node(int ix, int iy) const {
    if (!on_field(ix, iy)) {
      const int nx = surface_.nx();
      const int ny = surface_.ny();
      ix = ((ix % nx) + nx) % nx;
      iy = ((iy % ny) + ny) % ny;
    }
    return static_cast<size_t>(iy) * static_cast<size_t>(surface_.nx()) + static_cast<size_t>(ix);
  }
  GridNode place(int ix, int iy) const { return {node(ix, iy), ix, iy}; }
  GridNode place(size_t node) const {
    return {node, column(node),
            static_cast<int>(static_cast<uint32_t>(node) / static_cast<uint32_t>(surface_.nx()))};
  }
  /// Sets the number of the cell at a place. False: none is there.
  bool find(GridNode& at) const {
    if (!on_field(at.ix, at.iy) && !surface_.wrap()) return false;
    at.node = node(at.ix, at.iy);
    return true;
  }
  /// A part of a row of the grid, [first_ix, end_ix), of places as node() takes them, in runs of
  /// cells that follow each other: calls run(first node, its ix, length).
  template <typename Run>
  void each_run(int iy, int first_ix, int end_ix, const Run& run) const {
    for (int ix = first_ix; ix < end_ix;) {
      const size_t first = node(ix, iy);
      // A division less where the place is on the field.
      const int left_in_row = surface_.nx() - (ix >= 0 && ix < surface_.nx() ? ix : column(first));
      const int length = end_ix - ix < left_in_row ? end_ix - ix : left_in_row;
      run(first, ix, static_cast<size_t>(length));
      ix += length;
    }
  }

  /// All but the heights.
  template <typename Archive>
  void serialize(Archive& archive) {
    for (SoilCell& cell : cells_) archive(cell);
  }

 private:
  bool on_field(int ix, int iy) const {
    return ix >= 0 && iy >= 0 && ix < surface_.nx() && iy < surface_.ny();
  }
  int column(size_t node) const {
    return static_cast<int>(static_cast<uint32_t>(node) % static_cast<uint32_t>(surface_.nx()));
  }

  HeightField surface_;
  std::vector<SoilCell> cells_;
};

}  // namespace screed
