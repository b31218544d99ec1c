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
#pragma once

#include <algorithm>
#include <cstdint>

#include "host_sim/physics/kernels/kernels.h"

namespace screed {

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
  bool is_contact_new(uint32_t now) const { return step_ == 0 || step_ + 1 < now; }

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
  void release() { step_ = 0; }

 private:
  uint32_t step_ = 0;  // of the last contact; 0: there is none to go on with
  float covered_ = 0.0F;
  float old_sinkage_ = 0.0F;
  float beside_ = 0.0F;
};

}  // namespace screed
