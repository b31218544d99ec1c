// Repeated tests of a wheel: rows of measurements that are trials of the same test, and the mean
// and the error of what was measured in them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "host_sim/soil_validation/soil_measurements.h"

namespace screed {

/// Rows of one test, by their places among the measurements.
struct WheelTrials {
  double slip;  ///< mean
  double slip_angle_rad;
  std::vector<std::size_t> rows;
};

/// Slips of trials of one test differ by no more than this; loads by no more than a quarter. Both
/// are controlled, and measured in each trial.
inline constexpr double kSameSlip = 0.005;

/// All rows, by slip angle and slip from low to high. Trials of one test have the same wheel
/// (radius, width) and slip angle, and about the same slip and load.
std::vector<WheelTrials> wheel_trials(const std::vector<MeasuredWheel>& rows);

/// What was measured in the trials of one test.
struct TrialMean {
  double value;
  /// Of several trials the standard deviation (n - 1), at least the error that the rows state; of a
  /// single one what it states, or 0.
  double error;
  std::size_t trials;  ///< in which it was measured
};

/// A column of MeasuredWheel.
using WheelColumn = std::optional<double> MeasuredWheel::*;

/// Of the trials in which `value` was measured; nothing when it was in none. `error` may be null.
std::optional<TrialMean> mean_of_trials(const std::vector<MeasuredWheel>& rows,
                                        const WheelTrials& trials, WheelColumn value,
                                        WheelColumn error = nullptr);

}  // namespace screed
