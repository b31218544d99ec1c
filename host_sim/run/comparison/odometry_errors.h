// How far dead reckoning was off in a recorded run, and whether it knew: the firmware's own, and
// two plainer ones fed with the same samples.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/core/statistics.h"
#include "host_sim/core/task_progress.h"

namespace screed {

/// Ways to reckon, all from the same encoder counts.
enum class Reckoning : std::uint8_t {
  kFirmware,       ///< heading of the attitude estimator, travel less what slip takes
  kWithoutShare,   ///< the same heading, all of the travel
  kCountsAndGyro,  ///< heading of the gyroscope alone, true at the start; all of the travel
};
constexpr std::size_t kReckonings = 3;
const char* name_of(Reckoning reckoning);

/// A piece of the run, over which each began anew at the true place.
struct OdometryLeg {
  double start_s = 0.0;
  double duration_s = 0.0;
  double travelled_m = 0.0;                   ///< by the tracks, mean of both
  std::array<double, kReckonings> error_m{};  ///< at the end, on the plane
  /// Of the firmware's: squared error along x and y over the variance that it states, summed.
  /// Of a consistent estimate it has the chi-squared distribution of two degrees of freedom.
  double normalized_squared = 0.0;
};

/// Replays the recorded samples through the firmware, and cuts the run into legs of that length of
/// the true path [m], from when it first runs; what is left over at the end is dropped, and what
/// follows a fault. Position fixes and walls are not used: each leg is dead reckoning alone. Throws
/// InputError as replay_session() does.
std::vector<OdometryLeg> odometry_legs(const std::filesystem::path& session_file, double length_m,
                                       const TaskProgress& progress = {});

/// Of the legs of one or more runs, all of one length.
struct OdometrySummary {
  struct Errors {
    double median_m = 0.0;
    Interval median_95_m{};
    double ninety_percent_m = 0.0;
  };
  std::size_t legs = 0;
  std::array<Errors, kReckonings> errors{};
  /// Mean of normalized_squared over 2: 1 of a consistent estimate.
  double consistency = 0.0;
  Interval consistent{};  ///< 95 % of consistent ones lie there, if legs are independent
};
/// Throws std::invalid_argument without legs.
OdometrySummary summarize(const std::vector<OdometryLeg>& legs);

}  // namespace screed
