// Dead reckoning against the truth.
#include "host_sim/run/comparison/odometry_errors.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <stdexcept>

#include "firmware/estimation/position_estimate.h"
#include "firmware/math/units.h"
#include "firmware/robot/robot.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/statistics.h"
#include "host_sim/run/session/replay.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {
namespace {

constexpr double kSigmaUnit_m = 0.004;  // of Place::sigma, which is cut off
constexpr double kAnglePerRad = 32768.0 / std::numbers::pi;

/// What the tracks did in a tick, as the firmware takes it.
struct Counts {
  std::int16_t left;
  std::int16_t right;
};

class CountDeltas {
 public:
  Counts next(const SensorSample& sample) {
    return {next(sample.encoder_left, left_), next(sample.encoder_right, right_)};
  }

 private:
  // Modulo 2^16.
  static std::int16_t next(std::uint16_t now, std::uint16_t& last) {
    const auto delta = static_cast<std::int16_t>(static_cast<std::uint16_t>(now - last));
    last = now;
    return limit_i16(delta, kMaxTrackCounts);
  }

  std::uint16_t left_ = 0;
  std::uint16_t right_ = 0;
};

/// What the firmware senses in a tick.
struct Sensed {
  Counts counts;
  Angle heading;  ///< in the site
  Angle pitch;
  double yaw_rate;  ///< angle units a second
  std::uint8_t travel_share;
};

/// One way to reckon, over the leg so far.
class Reckoner {
 public:
  Reckoner(const SessionInfo& info, Reckoning way)
      : way_(way), estimate_(info.board.count_um_q4, info.parameters.position_noise()) {}

  void begin(double true_heading) {
    estimate_.reset();
    gyro_heading_ = true_heading;
  }

  void tick(const Sensed& sensed) {
    gyro_heading_ += sensed.yaw_rate / kTickRate_hz;
    const Angle heading =
        way_ == Reckoning::kCountsAndGyro ? rounded(gyro_heading_) : sensed.heading;
    const std::uint8_t share = way_ == Reckoning::kFirmware ? sensed.travel_share : UINT8_MAX;
    estimate_.update(sensed.counts.left, sensed.counts.right, heading, sensed.pitch, share);
  }

  Place place() const {
    Place place;
    estimate_.get(place);
    return place;
  }

 private:
  static Angle rounded(double angle) {
    return wrap_angle(static_cast<std::int32_t>(std::lround(angle)));
  }

  Reckoning way_;
  PositionEstimate estimate_;
  double gyro_heading_ = 0.0;  ///< angle units, of several turns
};

/// The leg that is being driven.
class CurrentLeg {
 public:
  explicit CurrentLeg(const SessionInfo& info)
      : m_per_count_(info.board.count_um_q4 / 16.0 * 1e-6) {
    for (std::size_t way = 0; way < kReckonings; ++way) {
      reckoners_.emplace_back(info, static_cast<Reckoning>(way));
    }
  }

  void begin(const SimFrame& frame) {
    leg_ = {.start_s = frame.time};
    x_m_ = y_m_ = path_m_ = 0.0;
    for (Reckoner& reckoner : reckoners_) reckoner.begin(frame.yaw * kAnglePerRad);
  }

  void tick(const Sensed& sensed, const SimFrame& frame) {
    for (Reckoner& reckoner : reckoners_) reckoner.tick(sensed);
    leg_.duration_s = frame.time - leg_.start_s;
    leg_.travelled_m +=
        0.5 * m_per_count_ * (std::abs(sensed.counts.left) + std::abs(sensed.counts.right));
    x_m_ += frame.delta_x;
    y_m_ += frame.delta_y;
    path_m_ += portable::hypot(frame.delta_x, frame.delta_y);
  }

  /// The true path so far.
  double path_m() const { return path_m_; }

  OdometryLeg ended() const {
    OdometryLeg leg = leg_;
    for (std::size_t way = 0; way < kReckonings; ++way) {
      const Place place = reckoners_[way].place();
      const double error_x = place.mm[kX] * 1e-3 - x_m_;
      const double error_y = place.mm[kY] * 1e-3 - y_m_;
      leg.error_m[way] = portable::hypot(error_x, error_y);
      if (static_cast<Reckoning>(way) != Reckoning::kFirmware) continue;
      const double sigma_x = (place.sigma[kX] + 0.5) * kSigmaUnit_m;
      const double sigma_y = (place.sigma[kY] + 0.5) * kSigmaUnit_m;
      leg.normalized_squared =
          error_x * error_x / (sigma_x * sigma_x) + error_y * error_y / (sigma_y * sigma_y);
    }
    return leg;
  }

 private:
  double m_per_count_;
  std::vector<Reckoner> reckoners_;
  OdometryLeg leg_;
  double x_m_ = 0.0;  ///< since the leg's start, true
  double y_m_ = 0.0;
  double path_m_ = 0.0;
};

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
  const Angle site_heading = angle_from_centidegrees(info.parameters.site_heading());
  const auto robot = std::make_unique<Robot>(info.board, info.parameters, info.credentials);
  RobotOutput output{};
  CountDeltas deltas;
  CurrentLeg leg(info);
  bool begun = false;
  std::vector<OdometryLeg> legs;
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
      robot->tick(samples[i], output);
      const Counts counts = deltas.next(samples[i]);
      // As recorded: a firmware that levels otherwise still senses the same.
      const auto state = static_cast<RobotState>(frames[i].state);
      if (state == RobotState::kFault) return legs;
      if (!begun) {
        begun = state == RobotState::kRunning;
        if (begun) leg.begin(frames[i]);
        continue;
      }
      const AttitudeAngles angles = robot->attitude().angles();
      leg.tick(
          {counts, wrap_angle(angles.heading - site_heading), angles.pitch,
           static_cast<double>(robot->attitude().yaw_rate()), robot->slip_watch().travel_share()},
          frames[i]);
      if (leg.path_m() < length_m) continue;
      legs.push_back(leg.ended());
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
  for (std::size_t way = 0; way < kReckonings; ++way) {
    std::vector<double> errors;
    errors.reserve(legs.size());
    for (const OdometryLeg& leg : legs) errors.push_back(leg.error_m[way]);
    summary.errors[way] = {quantile(errors, 0.5), median_interval(errors), quantile(errors, 0.9)};
  }
  for (const OdometryLeg& leg : legs) summary.consistency += leg.normalized_squared / (2.0 * count);
  summary.consistent = mean_square_interval(2.0 * count);
  return summary;
}

}  // namespace screed
