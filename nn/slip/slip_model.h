// The trained network of the slip watch as a file and as a header for the firmware.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nn/infer/gated.h"

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

}  // namespace screed::nn
