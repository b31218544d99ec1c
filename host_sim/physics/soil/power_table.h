// Bekker's z^n as a table: the power is asked for a thousand times a step.
#pragma once

#include <bit>
#include <cstdint>
#include <memory>
#include <vector>

#include "host_sim/physics/kernels/kernels.h"

namespace screed {

/// z^n for z >= 0 by linear interpolation between points whose distance grows with z: 32 in each
/// octave from 2^-24 m (60 nm) to 1 m. Relative error below 5e-4 for n <= 2.5 (3e-5 for 0.5 and
/// 1.1). Below 60 nm a straight line to 0, above 1 m the last one goes on.
class PowerTable {
 public:
  explicit PowerTable(double exponent);

  double exponent() const { return exponent_; }
  /// For kernels: the same lines; as long as the table lives.
  PowerLines lines() const {
    return {&lines_.front().offset, static_cast<double>(kFirst), static_cast<double>(kLines - 1),
            kDropped};
  }
  double power(double z) const {
    // A double's leading bits are its octave and place in it.
    int64_t i = (std::bit_cast<int64_t>(z) >> kDropped) - kFirst + 1;
    i = i < 0 ? 0 : i;
    i = i < kLines ? i : kLines - 1;
    const Line& line = lines_[static_cast<size_t>(i)];
    return line.offset + z * line.slope;
  }

 private:
  struct Line {
    double offset;
    double slope;
  };
  static constexpr int kDropped = 52 - 5;  // keeps 5 of 52 mantissa bits: 32 points an octave
  static constexpr int64_t kFirst = std::bit_cast<int64_t>(0x1p-24) >> kDropped;
  static constexpr int64_t kLines = (std::bit_cast<int64_t>(1.0) >> kDropped) - kFirst + 1;

  double exponent_;
  std::vector<Line> lines_;
};

using PowerTables = std::vector<PowerTable>;

/// Of n, n + step and so on, to n + most_more or just above it: how slip-sinkage raises Bekker's
/// exponent. All worlds of a process that ask for the same share them (a table has 12 kB); the last
/// one to go takes them along. May be called from any thread.
std::shared_ptr<const PowerTables> power_tables(double n, double step, double most_more);

}  // namespace screed
