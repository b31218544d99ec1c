// The trained network of the slip watch as a file and as a header for the firmware.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nn/infer/gated.h"
#include "nn/slip/stuck_rules.h"

namespace screed::nn {

/// Evidence (slip_watch.h) from which a robot slips, from which it is stuck, and below which it is
/// free again.
struct SlipThresholds {
  std::uint16_t slip = 32768;   ///< even odds
  std::uint16_t stuck = 40000;  ///< odds of 6; `screed nn slip choose` sets it
  std::uint16_t free = 28000;   ///< odds of 0.3
};

struct SlipModel {
  std::string training_data;  ///< hash over what it was trained on
  std::uint64_t seed = 0;     ///< of the training
  GatedShape shape{};
  std::vector<std::int8_t> parameters;  ///< in the order of nn/infer/gated.h
  SlipThresholds thresholds;
};

/// Throws InputError, one line with file, place and what is allowed, when the file is no such model
/// or its numbers do not fit together.
SlipModel read_slip_model(const std::filesystem::path& file);
/// The file appears complete or not at all. Throws RunError when it cannot be written.
void write_slip_model(const std::filesystem::path& file, const SlipModel& model);

/// Text of firmware/estimation/slip_model.h.
std::string slip_model_header(const SlipModel& model);

// The evidence from which on a robot counts as stuck, chosen on drives of their own.

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
