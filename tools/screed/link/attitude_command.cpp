// `screed attitude`: strict CSV reader, the estimator of the firmware, error measures of the BROAD
// benchmark.
#include "tools/screed/link/attitude_command.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <optional>
#include <string_view>

#include "firmware/estimation/attitude.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/csv_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "tools/screed/cli/command.h"

namespace screed {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr long kTickMs = 10;
// A tenth of gravity: nothing on Earth is moved so that it feels less for a whole recording.
constexpr double kMinMeanAcceleration = 410.0;

/// A rotation on the host: w, x, y, z, unit length.
using Rotation = std::array<double, 4>;

struct Row {
  ImuSample sample;
  std::optional<Rotation> reference;
  bool moving;
};

/// What a count of gyroscope, accelerometer and magnetometer is worth in the units of a recording.
using CountSizes = std::array<double, 3>;
constexpr CountSizes kInCounts = {1.0, 1.0, 1.0};
// 70 mdps in rad/s, 0.244 mg in m/s2 (data sheets of L3GD20H and LSM303D). A magnetometer's unit is
// free, since its direction counts and how its strength changes: the first row decides.
constexpr CountSizes kInSi = {0.07 / kDegrees, 0.244e-3 * kGravity_m_per_s2, 0.0};
constexpr double kFieldOfEarth = 3125.0;  // counts of 0.160 mG: 50 uT

/// Reads one recording, line by line.
class RecordingReader {
 public:
  RecordingReader(const std::string& file, bool si)
      : file_(file), reader_(file), sizes_(si ? kInSi : kInCounts) {
    if (!reader_.next(line_)) {
      throw InputError(file + ": column names are missing (gx,gy,gz,ax,ay,az,mx,my,mz,qw,...)");
    }
    names_ = line_.cells;
    for (std::size_t i = 0; i < kNames.size(); ++i) column_[i] = required_column(kNames[i]);
    const auto time = std::find(names_.begin(), names_.end(), "t_ms");
    if (time != names_.end()) time_column_ = static_cast<std::size_t>(time - names_.begin());
  }

  /// The next row, or nothing at the end of the file.
  std::optional<Row> next() {
    if (!reader_.next(line_)) return std::nullopt;
    if (line_.cells.size() != names_.size()) {
      fail("has " + std::to_string(line_.cells.size()) + " fields, the line of names has " +
           std::to_string(names_.size()));
    }
    check_time();
    if (sizes_[2] == 0.0) {
      const auto mag = [this](std::size_t i) { return number<double>(field(i), kNames[i]); };
      sizes_[2] = std::hypot(mag(6), mag(7), mag(8)) / kFieldOfEarth;
      if (!(sizes_[2] > 0.0)) fail("the magnetic field mx,my,mz is 0");
    }
    Row row{};
    for (std::size_t i = 0; i < 3; ++i) {
      row.sample.imu.gyro()[i] = count(i);
      row.sample.imu.accel()[i] = count(3 + i);
      row.sample.imu.mag()[i] = count(6 + i);
    }
    row.sample.mag_fresh = true;
    row.reference = reference();
    const std::string_view moving = field(kMoving);
    if (moving != "0" && moving != "1")
      fail("moving is '" + std::string(moving) + "', allowed are 0 and 1");
    row.moving = moving == "1";
    return row;
  }

 private:
  static constexpr std::array<std::string_view, 14> kNames = {
      "gx", "gy", "gz", "ax", "ay", "az", "mx", "my", "mz", "qw", "qx", "qy", "qz", "moving"};
  static constexpr std::size_t kReference = 9;
  static constexpr std::size_t kMoving = 13;

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file_ + ":" + std::to_string(line_.line) + ": " + what);
  }

  std::size_t required_column(std::string_view name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) fail("column " + std::string(name) + " is missing");
    if (std::find(found + 1, names_.end(), name) != names_.end()) {
      fail("column " + std::string(name) + " is there twice");
    }
    return static_cast<std::size_t>(found - names_.begin());
  }

  std::string_view field(std::size_t index) const { return line_.cells[column_[index]]; }

  template <class Number>
  Number number(std::string_view text, std::string_view name) const {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
      fail(std::string(name) + " is '" + std::string(text) + "', a number is needed");
    }
    return value;
  }

  std::int16_t count(std::size_t index) const {
    const double size = sizes_[index / 3];
    const double value = std::round(number<double>(field(index), kNames[index]) / size);
    if (!(value >= INT16_MIN && value <= INT16_MAX)) {
      fail(filled("{} is {}, allowed is {:g} to {:g}", kNames[index], field(index),
                  INT16_MIN * size, INT16_MAX * size));
    }
    return static_cast<std::int16_t>(value);
  }

  std::optional<Rotation> reference() const {
    std::size_t empty = 0;
    for (std::size_t i = 0; i < 4; ++i) empty += field(kReference + i).empty() ? 1U : 0U;
    if (empty == 4) return std::nullopt;
    Rotation q{};
    double squared = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      q[i] = number<double>(field(kReference + i), kNames[kReference + i]);
      squared += q[i] * q[i];
    }
    const double length = std::sqrt(squared);
    if (!(std::abs(length - 1.0) < 0.01)) {
      fail("the reference qw,qx,qy,qz has length " + std::to_string(length) + ", 1 is needed");
    }
    for (double& component : q) component /= length;
    return q;
  }

  void check_time() {
    if (!time_column_) return;
    const auto time = number<long>(line_.cells[*time_column_], "t_ms");
    if (previous_time_ && time - *previous_time_ != kTickMs) {
      fail("t_ms goes from " + std::to_string(*previous_time_) + " to " + std::to_string(time) +
           ", the estimator needs steps of 10");
    }
    previous_time_ = time;
  }

  std::string file_;
  CsvReader reader_;
  CsvLine line_;
  CountSizes sizes_;
  std::vector<std::string> names_;
  std::array<std::size_t, kNames.size()> column_{};
  std::optional<std::size_t> time_column_;
  std::optional<long> previous_time_;
};

Rotation rotation_of(const Quaternion& q) {
  const Rotation r = {static_cast<double>(q.w), static_cast<double>(q.x), static_cast<double>(q.y),
                      static_cast<double>(q.z)};
  const double length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
  return {r[0] / length, r[1] / length, r[2] / length, r[3] / length};
}

struct AttitudeError {
  double inclination_deg;
  double heading_deg;
};

/// Splits d = estimate reference* into a turn about the vertical and the rest, as D. Laidig et al.,
/// Data 6(7):72, 2021: inclination 2 acos sqrt(dw^2 + dz^2), heading 2 atan(dz / dw). The
/// inclination is computed as an asin of what is left, which is the same for unit quaternions and
/// exact for small angles.
AttitudeError error_between(const Rotation& e, const Rotation& o) {
  const double dw = e[0] * o[0] + e[1] * o[1] + e[2] * o[2] + e[3] * o[3];
  const double dx = -e[0] * o[1] + e[1] * o[0] - e[2] * o[3] + e[3] * o[2];
  const double dy = -e[0] * o[2] + e[1] * o[3] + e[2] * o[0] - e[3] * o[1];
  const double dz = -e[0] * o[3] - e[1] * o[2] + e[2] * o[1] + e[3] * o[0];
  return {2.0 * std::atan2(std::hypot(dx, dy), std::hypot(dw, dz)) * kDegrees,
          std::remainder(2.0 * std::atan2(dz, dw) * kDegrees, 360.0)};
}

void print_table(const std::vector<AttitudeScore>& scores, const AttitudeScore& mean,
                 std::ostream& out) {
  std::size_t width = 4;
  for (const AttitudeScore& score : scores) width = std::max(width, score.file.size());
  const auto row = [&](const std::string& name, const std::string& figures) {
    out << name << std::string(width - name.size(), ' ') << figures << '\n';
  };
  row("file", "  samples  inclination  heading");
  row("", "               RMS deg  RMS deg");
  for (const AttitudeScore& score : scores) {
    row(score.file, filled("{:9s}{:13.3f}{:9.3f}", score.samples, score.rms_inclination_deg,
                           score.rms_heading_deg));
  }
  row(mean.file,
      filled("{:9s}{:13.3f}{:9.3f}", "", mean.rms_inclination_deg, mean.rms_heading_deg));
}

void print_json(const std::vector<AttitudeScore>& scores, const AttitudeScore& mean,
                std::ostream& out) {
  Json files = Json::array();
  for (const AttitudeScore& score : scores) {
    files.push_back({{"file", score.file},
                     {"rms_heading_deg", score.rms_heading_deg},
                     {"rms_inclination_deg", score.rms_inclination_deg},
                     {"samples", score.samples}});
  }
  const Json whole = {{"files", files},
                      {"mean",
                       {{"rms_heading_deg", mean.rms_heading_deg},
                        {"rms_inclination_deg", mean.rms_inclination_deg}}}};
  out << whole.dump(2) << '\n';
}

}  // namespace

AttitudeScore score_attitude(const std::string& file, bool si) {
  RecordingReader reader(file, si);
  AttitudeEstimator estimator;
  AttitudeScore score;
  score.file = file;
  double inclination = 0.0;
  double heading = 0.0;
  double acceleration = 0.0;
  long rows = 0;
  while (const std::optional<Row> row = reader.next()) {
    estimator.update(row->sample);
    const auto* const accel = row->sample.imu.accel();
    acceleration += std::hypot(accel[0], accel[1], accel[2]);
    ++rows;
    if (!row->moving || !row->reference) continue;
    const AttitudeError error =
        error_between(rotation_of(estimator.orientation()), *row->reference);
    inclination += error.inclination_deg * error.inclination_deg;
    heading += error.heading_deg * error.heading_deg;
    ++score.samples;
  }
  if (rows > 0 && acceleration / static_cast<double>(rows) < kMinMeanAcceleration) {
    throw InputError(
        filled("{}: ax,ay,az are {:.1f} counts long on average, and 1 g is 4098 of them; {}", file,
               acceleration / static_cast<double>(rows),
               "for rad/s and m/s2, as ROS writes them, say --units si"));
  }
  if (score.samples == 0) {
    throw InputError(file +
                     ": no row counts; at least one needs moving = 1 and a reference qw,qx,qy,qz");
  }
  score.rms_inclination_deg = std::sqrt(inclination / static_cast<double>(score.samples));
  score.rms_heading_deg = std::sqrt(heading / static_cast<double>(score.samples));
  return score;
}

int run_attitude(const std::vector<std::string>& files, bool si, bool json, std::ostream& out) {
  std::vector<AttitudeScore> scores;
  AttitudeScore mean;
  mean.file = "mean";
  for (const std::string& file : files) {
    scores.push_back(score_attitude(file, si));
    mean.rms_inclination_deg +=
        scores.back().rms_inclination_deg / static_cast<double>(files.size());
    mean.rms_heading_deg += scores.back().rms_heading_deg / static_cast<double>(files.size());
  }
  if (json) {
    print_json(scores, mean, out);
  } else {
    print_table(scores, mean, out);
  }
  return 0;
}

void register_attitude_command(Command& root, Program& program) {
  struct Options {
    std::vector<std::string> files;
    std::string units = "counts";
    bool json = false;
  };
  auto [command, options] = add_subcommand<Options>(
      root, program, "attitude",
      "Run the attitude estimator over recordings with an optical reference and print its errors",
      [](const Options& given) {
        return run_attitude(given.files, given.units == "si", given.json, std::cout);
      });
  command.add_option("FILES", options.files, "CSV recordings (format: docs/attitude.md)")
      ->required();
  command
      .add_option(
          "--units", options.units,
          "Units of the recordings: counts of the sensors, or rad/s and m/s2, with any unit of "
          "the magnetic field")
      ->one_of({"counts", "si"})
      ->show_default();
  command.add_flag("--json", options.json, "Print JSON");
}

}  // namespace screed
