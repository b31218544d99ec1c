// What counts as dug in, as a detection and as a false alarm.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "nn/slip/slip_drive.h"

namespace screed::nn {

/// Dug in: over the next second the chassis travels less than this share of what the faster track
/// travels, and it has begun: at this moment it moves so as well.
inline constexpr double kDugInShare = 0.2;
/// An alarm is false when the chassis made more than this in the half second up to it: that it
/// would come free in the next moment cannot be known.
inline constexpr double kFreeShare = 0.4;

/// Answers questions on the motion of one drive; sums are formed once.
class TrueMotion {
 public:
  explicit TrueMotion(const SlipDrive& drive);

  /// Share of the faster track's travel that the chassis made, forward and turn, from tick `begin`
  /// to before `end` (limited to the drive); 1 when the tracks stood.
  double travel_share(std::size_t begin, std::size_t end) const;

  /// Forward alone: the chassis' share of the belts' mean travel, 0..1, and that travel, m.
  struct ForwardShare {
    double share;
    double belts_m;
  };
  ForwardShare forward_share(std::size_t begin, std::size_t end) const;

  /// The first tick at which the robot is dug in.
  std::optional<std::size_t> dug_in_at() const { return dug_in_; }

 private:
  std::optional<std::size_t> first_dug_in(const SlipDrive& drive) const;

  // Sums over the ticks before, one more than there are ticks.
  std::vector<double> distance_, turn_, faster_track_, belts_;
  std::optional<std::size_t> dug_in_;
};

/// What the watch said in one tick.
struct WatchTick {
  bool evaluated;  ///< the robot was running and its tracks fast enough
  bool stuck;
};

struct StuckCounts {
  // Of drives into a trap.
  int trapped = 0;       ///< drives
  int dug_in = 0;        ///< of them
  int detected = 0;      ///< of those
  double delay_s = 0.0;  ///< of the detection
  int early_alarms = 0;  ///< before it was dug in, that began after the robot had moved
  // Of drives without.
  double driven_s = 0.0;     ///< evaluated
  int false_alarms = 0;      ///< that began after the robot had moved
  int recovered_alarms = 0;  ///< not those, but with the half second after it it had: it came free
  int other_alarms = 0;      ///< that began while it hardly moved: slip, or dug in without a trap

  /// Adds all but the delay.
  StuckCounts& operator+=(const StuckCounts& other);
};

/// A drive into a trap is detected when `stuck` is set at any time from the moment at which it is
/// dug in to 1 s after it, unless by an early alarm of more than 1 s before. An early alarm is
/// what would be a false one without a trap; one that began within the second before is both. Stall
/// faults are no detections: they end the drive, and a drive that ends within the second is not dug
/// in.
StuckCounts count_alarms(const SlipDrive& drive, const TrueMotion& motion,
                         const std::vector<WatchTick>& watch);

}  // namespace screed::nn
