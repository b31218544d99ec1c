// When a run ends, and why: done, given up, off the bed, or told to stop.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "firmware/robot/supervisor.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/run/experiment/experiment.h"
#include "schema/values.h"

namespace screed {

/// Why a run ended. Of several reasons at once the first one counts.
enum class RunEnd : uint8_t {
  kDone,     ///< it lasted as long as the experiment says
  kFault,    ///< a fault ended the training drive: nobody clears it
  kLeftBed,  ///< the robot drove over the edge of the bed
  kStopped,  ///< it was told to stop
};

/// In words, to stand behind "ended: ".
const char* end_text(RunEnd end);

/// Frames of Algorithm 5 that a whole run of it drives; 0 under another algorithm.
uint64_t frames_to_drive(const Experiment& experiment);

/// A bed ends at its edges, unless it wraps around: a robot that drives over them has left its
/// site. Of the bed only the edges count.
bool left_bed(const HeightField& bed, const RobotView& robot);

class StopCondition {
 public:
  /// `stop` becomes true when the run is to end early; may be null, must outlive this.
  StopCondition(const Experiment& experiment, const std::atomic<bool>* stop);

  /// Counts one control tick, with the robot's states after it.
  void count_tick(RobotState state, message::LevelingState leveling);

  /// The run has lasted as long as it was to: the training drive (Algorithm 5) has driven all its
  /// frames, or idled for too long beside them; any other algorithm has had its duration.
  bool done() const;
  /// Whether no tick of the run can begin as late as this, s.
  bool is_over(double time_s) const;
  /// Nothing while the run is to go on. `off_bed`: see left_bed().
  std::optional<RunEnd> reason(bool off_bed) const;

  /// Control ticks so far.
  uint64_t ticks() const { return ticks_; }
  /// Of them those that were frames of Algorithm 5; 0 under another algorithm.
  uint64_t training_frames() const { return driven_; }
  /// Of the duration, s, at a simulated time: a training drive counts driven frames alone.
  double counted_s(double time_s) const;
  double duration_s() const { return duration_s_; }

 private:
  uint64_t ticks_to_run() const;  ///< of an algorithm that is not training drive

  uint64_t training_frames_;  ///< to be driven; 0 under another algorithm
  double duration_s_;
  const std::atomic<bool>* stop_;
  uint64_t ticks_ = 0;
  uint64_t driven_ = 0;
  bool fault_ = false;
};

}  // namespace screed
