// Dead reckoning against the truth.
#include "host_sim/run/comparison/odometry_errors.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "firmware/estimation/position_estimate.h"
#include "firmware/math/units.h"
#include "firmware/robot/robot.h"
#include "host_sim/core/display_units.h"
#include "host_sim/core/quantile.h"
#include "host_sim/run/session/replay.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {
namespace {

constexpr double kSigmaUnit_m = 0.004;  // of Place::sigma, which is cut off
constexpr double kNormal95 = 1.959964;
constexpr double kAnglePerRad = 32768.0 / 3.14159265358979323846;

/// One way to reckon, over the leg so far.
class Reckoner {
 public:
  Reckoner(const SessionInfo& info, Reckoning way)
      : way_(way), estimate_(info.board.count_um_q4, info.parameters.position_noise) {}

  void begin(Angle true_heading) {
    estimate_.reset();
    gyro_heading_ = true_heading * 256.0;
  }

  void tick(const Robot& robot, std::int16_t left, std::int16_t right, Angle site_heading) {
    const AttitudeAngles angles = robot.attitude().angles();
    gyro_heading_ += robot.attitude().yaw_rate() * 256.0 / kTickRate_hz;
    const Angle heading =
        way_ == Reckoning::kCountsAndGyro
            ? wrap_angle(static_cast<std::int32_t>(std::lround(gyro_heading_ / 256.0)))
            : wrap_angle(angles.heading - site_heading);
    const std::uint8_t share =
        way_ == Reckoning::kFirmware ? robot.slip_watch().travel_share() : UINT8_MAX;
    estimate_.update(left, right, heading, angles.pitch, share);
  }

  Place place() const {
    Place place;
    estimate_.get(place);
    return place;
  }

 private:
  Reckoning way_;
  PositionEstimate estimate_;
  double gyro_heading_ = 0.0;  ///< 2^-8 angle units
};

/// Quantile of the chi-squared distribution over its degrees of freedom (Wilson and Hilferty,
/// 1931).
double chi_squared_over_mean(double degrees, double z) {
  const double part = 2.0 / (9.0 * degrees);
  return std::pow(1.0 - part + z * std::sqrt(part), 3.0);
}

}  // namespace

const char* name_of(Reckoning reckoning) {
  switch (reckoning) {
    case Reckoning::kFirmware:
      return "firmware";
    case Reckoning::kWithoutShare:
      return "without the share of travel";
    case Reckoning::kCountsAndGyro:
      return "counts and gyroscope alone";
  }
  return "";
}

std::vector<OdometryLeg> odometry_legs(const std::filesystem::path& session_file, double length_m,
                                       const TaskProgress& progress) {
  constexpr std::uint64_t kBlockRows = 1024;
  const SessionReader session(session_file);
  check_replayable(session, session_file);
  const SessionInfo& info = session.info();
  const auto robot = std::make_unique<Robot>(info.board, info.parameters, info.credentials);
  RobotOutput output{};
  std::vector<Reckoner> reckoners;
  for (std::size_t way = 0; way < kReckonings; ++way) {
    reckoners.emplace_back(info, static_cast<Reckoning>(way));
  }
  const Angle site_heading = angle_from_centidegrees(info.parameters.site_heading);

  std::vector<OdometryLeg> legs;
  OdometryLeg leg;
  bool begun = false;
  double true_x = 0.0;  // since the leg's start
  double true_y = 0.0;
  double path_m = 0.0;
  std::uint16_t last_left = 0;
  std::uint16_t last_right = 0;
  const double m_per_count = info.board.count_um_q4 / 16.0 * 1e-6;
  std::vector<SensorSample> samples;
  std::vector<SimFrame> frames;
  for (std::uint64_t first = 0; first < session.frames(); first += frames.size()) {
    report_progress(progress, "replaying", first, session.frames());
    const std::uint64_t count = std::min(kBlockRows, session.frames() - first);
    samples.resize(count);
    frames.resize(count);
    session.read(first, std::span(samples));
    session.read(first, std::span(frames));
    for (std::uint64_t i = 0; i < count; ++i) {
      const SimFrame& frame = frames[i];
      robot->tick(samples[i], output);
      // Modulo 2^16, as the firmware takes them.
      const auto left = static_cast<std::int16_t>(
          static_cast<std::uint16_t>(samples[i].encoder_left - last_left));
      const auto right = static_cast<std::int16_t>(
          static_cast<std::uint16_t>(samples[i].encoder_right - last_right));
      last_left = samples[i].encoder_left;
      last_right = samples[i].encoder_right;
      // As recorded: a firmware that levels otherwise still senses the same.
      const auto state = static_cast<RobotState>(frame.state);
      if (state == RobotState::kFault) return legs;
      if (!begun) {
        if (state != RobotState::kRunning) continue;
        begun = true;
        leg = {.start_s = frame.time};
        true_x = true_y = path_m = 0.0;
        const Angle heading =
            wrap_angle(static_cast<std::int32_t>(std::lround(frame.yaw * kAnglePerRad)));
        for (Reckoner& reckoner : reckoners) reckoner.begin(heading);
        continue;
      }
      for (Reckoner& reckoner : reckoners) reckoner.tick(*robot, left, right, site_heading);
      leg.travelled_m += 0.5 * m_per_count * (std::abs(left) + std::abs(right));
      true_x += frame.delta_x;
      true_y += frame.delta_y;
      path_m += std::hypot(frame.delta_x, frame.delta_y);
      if (path_m < length_m) continue;
      leg.duration_s = frame.time - leg.start_s;
      for (std::size_t way = 0; way < kReckonings; ++way) {
        const Place place = reckoners[way].place();
        const double error_x = place.mm[kX] * 1e-3 - true_x;
        const double error_y = place.mm[kY] * 1e-3 - true_y;
        leg.error_m[way] = std::hypot(error_x, error_y);
        if (static_cast<Reckoning>(way) != Reckoning::kFirmware) continue;
        const double sigma_x = (place.sigma[kX] + 0.5) * kSigmaUnit_m;
        const double sigma_y = (place.sigma[kY] + 0.5) * kSigmaUnit_m;
        leg.normalized_squared =
            error_x * error_x / (sigma_x * sigma_x) + error_y * error_y / (sigma_y * sigma_y);
      }
      legs.push_back(leg);
      begun = false;
    }
  }
  return legs;
}

OdometrySummary summarize(const std::vector<OdometryLeg>& legs) {
  if (legs.empty()) throw std::invalid_argument("no leg to summarize");
  OdometrySummary summary;
  summary.legs = legs.size();
  const auto count = static_cast<double>(legs.size());
  // The median's rank, binomial, as shares of the sorted sample.
  const double half_width = 0.5 * kNormal95 / std::sqrt(count);
  for (std::size_t way = 0; way < kReckonings; ++way) {
    std::vector<double> errors;
    errors.reserve(legs.size());
    for (const OdometryLeg& leg : legs) errors.push_back(leg.error_m[way]);
    summary.errors[way] = {quantile(errors, 0.5), quantile(errors, std::max(0.0, 0.5 - half_width)),
                           quantile(errors, std::min(1.0, 0.5 + half_width)),
                           quantile(errors, 0.9)};
  }
  for (const OdometryLeg& leg : legs) summary.consistency += leg.normalized_squared / (2.0 * count);
  summary.consistency_low = chi_squared_over_mean(2.0 * count, -kNormal95);
  summary.consistency_high = chi_squared_over_mean(2.0 * count, kNormal95);
  return summary;
}

}  // namespace screed
