// Many seeded drives: how the slip watch does in them, and the threshold that is chosen by them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "nn/slip/slip_model.h"
#include "nn/slip/stuck_rules.h"

namespace screed::nn {

/// Many seeded drives.
struct SlipCampaign {
  std::uint64_t seed = 1;   ///< of the first drive of each kind; each further one adds 1
  std::size_t trapped = 0;  ///< numbers of drives
  std::size_t free = 0;
  std::size_t ordinary = 0;
  double duration_s = 60.0;  ///< of a drive without a trap; one into a trap takes 14 s
  unsigned threads = 1;
  std::filesystem::path folder;  ///< of recorded drives; empty: none are kept
};

std::vector<StuckScenario> scenarios(const SlipCampaign& campaign);
std::vector<SlipDrive> run(const SlipCampaign& campaign, const TaskProgress& progress);

/// Errors of the travel share, weighted by the belts' speed.
struct ShareError {
  double weight = 0.0;
  double sum = 0.0;              ///< of share said minus true share
  double squares = 0.0;          ///< of that
  double true_sum = 0.0;         ///< of true shares
  double true_squares = 0.0;     ///< of those
  double missing_squares = 0.0;  ///< of 1 minus true shares

  void add(double said, double truth, double weight_of_it);
  double mean() const { return sum / weight; }
  double rms() const;
  double true_mean() const { return true_sum / weight; }
  double rms_of_one() const;   ///< where the share is said to be always 1
  double rms_of_mean() const;  ///< where it is said to be always the mean of the true ones
};

struct SlipFigures {
  StuckCounts all;
  std::map<std::string, StuckCounts> by_trap;  ///< none: without a trap
  std::map<std::string, StuckCounts> by_ground;
  std::map<std::string, ShareError> share_by_ground;
  ShareError share;
  std::vector<double> delays_s;
  std::vector<std::uint64_t> missed;  ///< seeds
  int failures = 0;
};

/// Of the watch with the network of this build.
SlipFigures figures_of(const std::vector<SlipDrive>& drives);

/// The evidence from which on a robot counts as stuck, as it did on drives of their own.
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
