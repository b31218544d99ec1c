// Tables of measurements.
#include "host_sim/soil_validation/soil_measurements.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <tuple>

#include "host_sim/core/csv_file.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

/// A row by the names of its columns.
class Row {
 public:
  Row(const std::string& file, int line, const std::vector<std::string>& names,
      const std::vector<std::string>& fields)
      : file_(file), line_(line), names_(names), fields_(fields) {}

  bool has(const char* name) const { return !text(name).empty(); }
  const std::string& text(const char* name) const {
    static const std::string kNone;
    const auto at =
        static_cast<size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
    return at < names_.size() && at < fields_.size() ? fields_[at] : kNone;
  }
  double number(const char* name, double low, double high) const {
    const std::string& field = text(name);
    if (field.empty()) fail(std::string("no ") + name);
    double value = 0.0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    const bool read = error == std::errc() && end == field.data() + field.size();
    if (!read || !(value >= low && value <= high)) {
      char text[200];
      std::snprintf(text, sizeof text, "%s is '%s', a number from %g to %g is needed", name,
                    field.c_str(), low, high);
      fail(text);
    }
    return value;
  }
  std::optional<double> measured(const char* name, double low, double high) const {
    if (!has(name)) return std::nullopt;
    return number(name, low, high);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file_ + ":" + std::to_string(line_) + ": " + what);
  }

  const std::string& file_;
  int line_;
  const std::vector<std::string>& names_;
  const std::vector<std::string>& fields_;
};

MeasuredWheel wheel_of(const Row& row) {
  constexpr double kForce_n = 1e6;
  MeasuredWheel wheel;
  wheel.name = row.text("case");
  wheel.wheel.radius_m = row.number("wheel_radius_m", 1e-3, 10.0);
  wheel.wheel.width_m = row.number("wheel_width_m", 1e-3, 10.0);
  wheel.wheel.load_n = row.number("load_n", 1e-3, kForce_n);
  wheel.wheel.slip = row.number("slip", -1.0, 0.99);
  const double slip_angle_deg = row.measured("slip_angle_deg", -80.0, 80.0).value_or(0.0);
  wheel.wheel.slip_angle_rad = slip_angle_deg * std::numbers::pi / 180.0;
  wheel.drawbar_pull_n = row.measured("drawbar_pull_n", -kForce_n, kForce_n);
  wheel.side_force_n = row.measured("side_force_n", -kForce_n, kForce_n);
  wheel.torque_nm = row.measured("torque_nm", -kForce_n, kForce_n);
  wheel.sinkage_m = row.measured("sinkage_m", 1e-6, 10.0);
  wheel.drawbar_pull_error_n = row.measured("drawbar_pull_error_n", 0.0, kForce_n);
  wheel.side_force_error_n = row.measured("side_force_error_n", 0.0, kForce_n);
  wheel.sinkage_error_m = row.measured("sinkage_error_m", 0.0, 10.0);
  return wheel;
}

MeasuredPlate plate_of(const Row& row) {
  const double width = row.number("plate_width_m", 1e-3, 10.0);
  const double length = row.number("plate_length_m", 1e-3, 10.0);
  return {row.text("case"),
          std::min(width, length),
          std::max(width, length),
          row.measured("round", 0.0, 1.0).value_or(0.0) != 0.0,
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
  if (!wheels && !has("plate_width_m")) {
    throw InputError(file + ":" + std::to_string(line.line) +
                     ": neither a column wheel_radius_m (wheels) nor plate_width_m (plates)");
  }
  SoilMeasurements all;
  while (reader.next(line)) {
    const Row row(file, line.line, names, line.cells);
    if (!row.text("case").starts_with(prefix)) continue;
    if (wheels) {
      all.wheels.push_back(wheel_of(row));
    } else {
      all.plates.push_back(plate_of(row));
    }
  }
  if (all.wheels.empty() && all.plates.empty()) {
    throw InputError(file + ": no case begins with '" + prefix + "'");
  }
  return all;
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
