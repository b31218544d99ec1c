// The evidence from which on a robot counts as stuck, chosen on drives of their own.
#pragma once

#include <vector>

#include "nn/slip/slip_model.h"
#include "nn/slip/stuck_rules.h"

namespace screed::nn {

struct ThresholdResult {
  std::uint16_t stuck = 0;
  StuckCounts counts;
};

/// Counts of every threshold tried, rising, with the network of the model and its threshold of
/// free.
std::vector<ThresholdResult> try_thresholds(const SlipModel& model,
                                            const std::vector<SlipDrive>& drives);

/// Of the thresholds from which on all have at most that many false alarms an hour and early alarms
/// a drive into a trap, the one that detects most, the highest of those that detect equally many.
/// The highest one where none holds.
std::uint16_t choose_threshold(const std::vector<ThresholdResult>& results, double false_per_hour,
                               double early_per_drive);

}  // namespace screed::nn
