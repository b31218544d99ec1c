// The slip watch judged on recorded drives: what counts as dug in, as a detection and as a false
// alarm; the watch replayed; its network's steps with what they are to say.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "firmware/estimation/slip_watch.h"
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

/// What the firmware's slip watch did in one tick of a recorded drive.
struct ReplayedTick {
  bool evaluated;  ///< the tracks were fast enough and the robot was running
  bool concluded;  ///< a step of the network ended
  bool forgets;    ///< with concluded: the states were zeroed since the step before
};

/// Calls `on_tick` after every tick of the drive. The drives' board is the default one.
void replay(const SlipDrive& drive,
            const std::function<void(std::size_t tick, const SlipWatch& watch,
                                     const ReplayedTick& what)>& on_tick);

/// Flags of the watch with the network of this build.
std::vector<WatchTick> watch_of(const SlipDrive& drive);

/// One step of the watch's network, every fourth tick in which it runs: its inputs, and what it is
/// to say.
struct SlipStep {
  std::array<std::int8_t, kSlipInputs> inputs;
  std::uint32_t tick;  ///< at which the answer is known
  bool forgets;        ///< the tracks stood since the step before: the states are zero again
  float held;          ///< 1: it hardly moves, 0: it moves
  float held_weight;   ///< 0: unclear, teaches nothing; else 1
  float share;         ///< of the belts' travel over the last half second that the chassis made
  float share_weight;  ///< the belts' mean speed over that time, m/s; 0: it teaches nothing
};

/// Steps of a drive: those inputs that the firmware's slip watch makes of it. Held is a robot that
/// makes less than 0.25 of the tracks' travel in the 15 ticks before and after, free one that makes
/// more than 0.4.
std::vector<SlipStep> slip_steps(const SlipDrive& drive, const TrueMotion& motion);

}  // namespace screed::nn
