// Slip of the left and of the right track, from what a robot says of both together
// (docs/telemetry.md#track-slip).
//
// POSITION carries the share of the tracks' mean travel that moves the robot, ENCODERS what each
// track travels, ODOMETRY the heading. Over half a second, as the share is taken:
//
//   v = share (left + right) / 2             travel of the chassis' middle
//   slip of a track = 1 - (v -+ turn tread / 2) / its travel
//
// with the turn counter-clockwise and its sign minus on the left. Slip is 0 of a track that rolls,
// 1 of one that spins on the spot, negative of one that is dragged along.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "firmware/parameters/board_constants.h"
#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {

/// Nothing of a track that travels less than kMinTravel_m in half a second: its slip means
/// nothing.
struct TrackSlip {
  std::optional<double> left;
  std::optional<double> right;
};

/// Of one robot. Takes its messages in the order of time.
class TrackSlipEstimate {
 public:
  static constexpr std::uint64_t kWindow_us = 500'000;
  static constexpr double kMinTravel_m = 0.01;

  explicit TrackSlipEstimate(const BoardConstants& board);

  /// `bits`: the 8 bytes of a message as one number. The slip with each POSITION for which counts
  /// and headings of the half second before are there, from [-1, 1.5]; nothing with other messages.
  std::optional<TrackSlip> add(std::uint64_t time_us, const MessageInfo& message,
                               std::uint64_t bits);

 private:
  /// What has been travelled or turned since the first message, rising beyond the signal's range.
  struct Point {
    std::uint64_t time_us;
    double left_or_turn;
    double right;
  };
  /// The newest last; one at least is older than the window.
  using Track = std::deque<Point>;

  void add_encoders(std::uint64_t time_us, std::uint64_t bits);
  void add_heading(std::uint64_t time_us, std::uint64_t bits);
  static void remember(Track& track, const Point& point);
  static std::optional<Point> at(const Track& track, std::uint64_t time_us);

  double count_m_;
  double tread_m_;
  const MessageInfo* encoders_;
  const MessageInfo* odometry_;
  const MessageInfo* position_;
  std::int64_t last_left_ = 0;
  std::int64_t last_right_ = 0;
  double last_heading_rad_ = 0.0;
  Track travel_;  ///< m, left and right
  Track turn_;    ///< rad
};

}  // namespace screed
