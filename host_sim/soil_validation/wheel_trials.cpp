// Groups of rows, means and standard deviations.
#include "host_sim/soil_validation/wheel_trials.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "host_sim/core/elementary.h"

namespace screed {
namespace {

constexpr double kSameLoad = 0.25;  // of the greater one

bool same_test(const RollingWheel& a, const RollingWheel& b) {
  return a.radius_m == b.radius_m && a.width_m == b.width_m &&
         a.slip_angle_rad == b.slip_angle_rad && std::abs(a.slip - b.slip) <= kSameSlip &&
         std::abs(a.load_n - b.load_n) <= kSameLoad * std::max(a.load_n, b.load_n);
}

}  // namespace

std::vector<WheelTrials> wheel_trials(const std::vector<MeasuredWheel>& rows) {
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&rows](std::size_t a, std::size_t b) {
    const auto key = [](const RollingWheel& wheel) {
      return std::tuple(wheel.slip_angle_rad, wheel.slip);
    };
    return key(rows[a].wheel) < key(rows[b].wheel);
  });
  std::vector<WheelTrials> all;
  for (const std::size_t row : order) {
    // By its first row, so that no chain of rows drifts away from it.
    const auto same = std::find_if(all.begin(), all.end(), [&](const WheelTrials& trials) {
      return same_test(rows[trials.rows[0]].wheel, rows[row].wheel);
    });
    if (same != all.end()) {
      same->rows.push_back(row);
    } else {
      all.push_back({0.0, rows[row].wheel.slip_angle_rad, {row}});
    }
  }
  for (WheelTrials& trials : all) {
    for (const std::size_t row : trials.rows) trials.slip += rows[row].wheel.slip;
    trials.slip /= static_cast<double>(trials.rows.size());
  }
  return all;
}

std::optional<TrialMean> mean_of_trials(const std::vector<MeasuredWheel>& rows,
                                        const WheelTrials& trials, WheelColumn value,
                                        WheelColumn error) {
  TrialMean mean{0.0, 0.0, 0};
  for (const std::size_t row : trials.rows) {
    if (!(rows[row].*value)) continue;
    mean.value += *(rows[row].*value);
    ++mean.trials;
    if (error != nullptr) mean.error = std::max(mean.error, (rows[row].*error).value_or(0.0));
  }
  if (mean.trials == 0) return std::nullopt;
  mean.value /= static_cast<double>(mean.trials);
  if (mean.trials == 1) return mean;
  double squares = 0.0;
  for (const std::size_t row : trials.rows) {
    if (rows[row].*value) squares += portable::pow(*(rows[row].*value) - mean.value, 2.0);
  }
  mean.error = std::max(mean.error, std::sqrt(squares / (static_cast<double>(mean.trials) - 1.0)));
  return mean;
}

}  // namespace screed
