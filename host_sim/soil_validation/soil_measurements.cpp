// Tables of measurements.
#include "host_sim/soil_validation/soil_measurements.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

#include "host_sim/core/csv_file.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

MeasuredWheel wheel_of(const CsvRow& row) {
  constexpr double kForce_n = 1e6;
  MeasuredWheel wheel;
  wheel.name = row.text("case");
  wheel.wheel.radius_m = row.number("wheel_radius_m", 1e-3, 10.0);
  wheel.wheel.width_m = row.number("wheel_width_m", 1e-3, 10.0);
  wheel.wheel.load_n = row.number("load_n", 1e-3, kForce_n);
  wheel.wheel.slip = row.number("slip", -1.0, 0.99);
  const double slip_angle_deg = row.number_if_any("slip_angle_deg", -80.0, 80.0).value_or(0.0);
  wheel.wheel.slip_angle_rad = slip_angle_deg * std::numbers::pi / 180.0;
  wheel.drawbar_pull_n = row.number_if_any("drawbar_pull_n", -kForce_n, kForce_n);
  wheel.side_force_n = row.number_if_any("side_force_n", -kForce_n, kForce_n);
  wheel.torque_nm = row.number_if_any("torque_nm", -kForce_n, kForce_n);
  wheel.sinkage_m = row.number_if_any("sinkage_m", 1e-6, 10.0);
  wheel.drawbar_pull_error_n = row.number_if_any("drawbar_pull_error_n", 0.0, kForce_n);
  wheel.side_force_error_n = row.number_if_any("side_force_error_n", 0.0, kForce_n);
  wheel.sinkage_error_m = row.number_if_any("sinkage_error_m", 0.0, 10.0);
  return wheel;
}

/// A row of a transient: to the last one, or a new one.
void add_transient(const CsvRow& row, std::vector<MeasuredTransient>& transients) {
  constexpr double kSpeed = 10.0;
  MeasuredTransient one;
  one.name = row.text("case");
  one.wheel.radius_m = row.number("wheel_radius_m", 1e-3, 10.0);
  one.wheel.width_m = row.number("wheel_width_m", 1e-3, 10.0);
  one.wheel.load_n = row.number("load_n", 1e-3, 1e6);
  const double slip_angle_deg = row.number_if_any("slip_angle_deg", -180.0, 180.0).value_or(0.0);
  one.wheel.slip_angle_rad = slip_angle_deg * std::numbers::pi / 180.0;
  one.travel_m_per_s = row.number("travel_m_s", -kSpeed, kSpeed);
  one.rim_m_per_s = row.number("rim_m_s", -kSpeed, kSpeed);
  one.time_constant_s = row.number("rim_time_constant_s", 1e-3, 10.0);
  if (one.rim_m_per_s == one.travel_m_per_s * portable::cos(one.wheel.slip_angle_rad))
    row.refuse("rim_m_s is that of the travel ahead; a transient needs another one");
  const MeasuredTransient::Place place = {
      row.number("slip_path_m", -1e3, 1e3), row.number("extra_sinkage_m", -10.0, 10.0),
      row.number_if_any("extra_sinkage_error_m", 0.0, 10.0).value_or(0.0)};
  if (transients.empty() || transients.back().name != one.name) {
    transients.push_back(one);
  } else if (!(std::abs(place.slip_path_m) >
               std::abs(transients.back().places.back().slip_path_m))) {
    row.refuse("slip_path_m must grow from row to row of a case");
  }
  transients.back().places.push_back(place);
}

MeasuredPlate plate_of(const CsvRow& row) {
  const double width = row.number("plate_width_m", 1e-3, 10.0);
  const double length = row.number("plate_length_m", 1e-3, 10.0);
  return {row.text("case"),
          std::min(width, length),
          std::max(width, length),
          row.number_if_any("round", 0.0, 1.0).value_or(0.0) != 0.0,
          row.number("depth_m", 1e-6, 10.0),
          row.number("pressure_pa", 1e-3, 1e9)};
}

}  // namespace

SoilMeasurements read_soil_measurements(const std::string& file, const std::string& prefix) {
  CsvReader reader(file);
  CsvLine line;
  if (!reader.next(line)) throw InputError(file + ": is empty");
  const std::vector<std::string> names = line.cells;
  const auto has = [&](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const bool wheels = has("wheel_radius_m");
  const bool transients = has("slip_path_m");
  if (!wheels && !has("plate_width_m")) {
    throw InputError(file + ":" + std::to_string(line.line) +
                     ": neither a column wheel_radius_m (wheels) nor plate_width_m (plates)");
  }
  SoilMeasurements all;
  while (reader.next(line)) {
    const CsvRow row(file, names, line);
    if (!row.text("case").starts_with(prefix)) continue;
    if (transients) {
      add_transient(row, all.transients);
    } else if (wheels) {
      all.wheels.push_back(wheel_of(row));
    } else {
      all.plates.push_back(plate_of(row));
    }
  }
  if (all.wheels.empty() && all.transients.empty() && all.plates.empty()) {
    throw InputError(file + ": no case begins with '" + prefix + "'");
  }
  return all;
}

WheelSchedule MeasuredTransient::schedule() const {
  const double ahead = travel_m_per_s * portable::cos(wheel.slip_angle_rad);
  // Half a dozen time constants, and the way to the last place.
  const double duration =
      6.0 * time_constant_s + std::abs(places.back().slip_path_m) / std::abs(rim_m_per_s - ahead);
  return step_of_slip(travel_m_per_s, wheel.slip_angle_rad, rim_m_per_s, time_constant_s, duration);
}

std::vector<double> MeasuredTransient::extra_sinkage_m(
    const std::vector<WheelSample>& samples) const {
  std::vector<double> extra;
  auto after = samples.begin();
  for (const Place& place : places) {
    while (after + 1 != samples.end() && std::abs(after->slip_path_m) < std::abs(place.slip_path_m))
      ++after;
    double sinkage = after->sinkage_m;
    if (after != samples.begin()) {
      const WheelSample& before = *(after - 1);
      const double share = std::clamp(
          (place.slip_path_m - before.slip_path_m) / (after->slip_path_m - before.slip_path_m), 0.0,
          1.0);
      sinkage = before.sinkage_m + share * (after->sinkage_m - before.sinkage_m);
    }
    extra.push_back(sinkage - samples.front().sinkage_m);
  }
  return extra;
}

// ---- trials of the same test: means and standard deviations

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
