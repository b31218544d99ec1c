#include "host_sim/ground_station/telemetry/track_slip.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace screed {
namespace {

/// A robot that restarted, or a log with a gap: what came before is no history.
constexpr std::uint64_t kGap_us = 1'000'000;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

/// Of a signal of the message.
double value_of(const MessageInfo& message, const char* name, std::uint64_t bits) {
  const SignalInfo& signal = *message.signal(name);
  return signal.value(signal.raw(bits));
}

std::optional<double> slip(double chassis_m, double track_m) {
  if (std::abs(track_m) < TrackSlipEstimate::kMinTravel_m) return std::nullopt;
  return std::clamp(1.0 - chassis_m / track_m, -1.0, 1.5);
}

}  // namespace

TrackSlipEstimate::TrackSlipEstimate(const BoardConstants& board)
    : count_m_(board.count_um_q4 / 16.0 * 1e-6),
      tread_m_(board.tread_mm * 1e-3),
      encoders_(find_message("ENCODERS")),
      odometry_(find_message("ODOMETRY")),
      position_(find_message("POSITION")) {}

void TrackSlipEstimate::remember(Track& track, const Point& point) {
  if (!track.empty() &&
      (point.time_us <= track.back().time_us || point.time_us > track.back().time_us + kGap_us)) {
    track.clear();
  }
  track.push_back(point);
  while (track.size() > 2 && track[1].time_us + 2 * kWindow_us < point.time_us) track.pop_front();
}

void TrackSlipEstimate::add_encoders(std::uint64_t time_us, std::uint64_t bits) {
  const std::int64_t left = encoders_->signal("left")->raw(bits);
  const std::int64_t right = encoders_->signal("right")->raw(bits);
  Point point{time_us, 0.0, 0.0};
  if (!travel_.empty()) {
    // Counts wrap at 16 bits.
    const auto step = [](std::int64_t now, std::int64_t before) {
      return static_cast<double>(static_cast<std::int16_t>(now - before));
    };
    point.left_or_turn = travel_.back().left_or_turn + step(left, last_left_) * count_m_;
    point.right = travel_.back().right + step(right, last_right_) * count_m_;
  }
  last_left_ = left;
  last_right_ = right;
  remember(travel_, point);
}

void TrackSlipEstimate::add_heading(std::uint64_t time_us, std::uint64_t bits) {
  const double heading_rad = radians(value_of(*odometry_, "heading", bits));
  Point point{time_us, 0.0, 0.0};
  if (!turn_.empty()) {
    point.left_or_turn = turn_.back().left_or_turn +
                         std::remainder(heading_rad - last_heading_rad_, 2.0 * std::numbers::pi);
  }
  last_heading_rad_ = heading_rad;
  remember(turn_, point);
}

std::optional<TrackSlipEstimate::Point> TrackSlipEstimate::at(const Track& track,
                                                              std::uint64_t time_us) {
  const auto after = std::find_if(track.begin(), track.end(), [time_us](const Point& point) {
    return point.time_us >= time_us;
  });
  if (after == track.end()) return std::nullopt;
  if (after->time_us == time_us) return *after;
  if (after == track.begin()) return std::nullopt;
  const Point& before = *(after - 1);
  const double share = static_cast<double>(time_us - before.time_us) /
                       static_cast<double>(after->time_us - before.time_us);
  return Point{time_us, std::lerp(before.left_or_turn, after->left_or_turn, share),
               std::lerp(before.right, after->right, share)};
}

std::optional<TrackSlip> TrackSlipEstimate::add(std::uint64_t time_us, const MessageInfo& message,
                                                std::uint64_t bits) {
  if (&message == encoders_) add_encoders(time_us, bits);
  if (&message == odometry_) add_heading(time_us, bits);
  if (&message != position_ || travel_.empty() || turn_.empty()) return std::nullopt;
  const std::uint64_t end_us = std::min(travel_.back().time_us, turn_.back().time_us);
  if (end_us < kWindow_us) return std::nullopt;
  const auto travel_begin = at(travel_, end_us - kWindow_us);
  const auto travel_end = at(travel_, end_us);
  const auto turn_begin = at(turn_, end_us - kWindow_us);
  const auto turn_end = at(turn_, end_us);
  if (!travel_begin || !travel_end || !turn_begin || !turn_end) return std::nullopt;
  const double left = travel_end->left_or_turn - travel_begin->left_or_turn;
  const double right = travel_end->right - travel_begin->right;
  const double turned = (turn_end->left_or_turn - turn_begin->left_or_turn) * tread_m_ / 2.0;
  const double middle = value_of(*position_, "travel_share", bits) / 100.0 * (left + right) / 2.0;
  return TrackSlip{slip(middle - turned, left), slip(middle + turned, right)};
}

}  // namespace screed
