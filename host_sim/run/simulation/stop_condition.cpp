// Counting ticks, and who ends a run.
#include "host_sim/run/simulation/stop_condition.h"

#include <algorithm>
#include <cmath>

#include "hal/sample.h"

namespace screed {
namespace {

// How long a training drive may take beyond its frames: to arm and to start.
constexpr uint64_t kMaxIdleTicks = 60U * uint64_t{kTickRate_hz};

}  // namespace

const char* end_text(RunEnd end) {
  switch (end) {
    case RunEnd::kDone:
      return "done";
    case RunEnd::kFault:
      return "a fault stopped the training drive";
    case RunEnd::kLeftBed:
      return "the robot left the bed";
    case RunEnd::kStopped:
      return "stopped on request";
  }
  return "unknown";
}

uint64_t frames_to_drive(const Experiment& experiment) {
  if (experiment.experiment.algorithm != kTrainingDriveName) return 0;
  const uint64_t all = experiment.experiment.frames.value();
  if (!experiment.experiment.stop_after_s.has_value()) return all;
  const auto some = std::llround(*experiment.experiment.stop_after_s * kTickRate_hz);
  return std::min(all, static_cast<uint64_t>(some));
}

bool left_bed(const HeightField& bed, const RobotView& robot) {
  const Eigen::Vector3d place = robot.vehicle().chassis().pose.translation();
  return !bed.wrap() && !bed.inside(place.x(), place.y());
}

StopCondition::StopCondition(const Experiment& experiment, const std::atomic<bool>* stop)
    : training_frames_(frames_to_drive(experiment)),
      duration_s_(experiment.experiment.duration_s),
      stop_(stop) {}

void StopCondition::count_tick(RobotState state, message::LevelingState leveling) {
  ++ticks_;
  fault_ = state == RobotState::kFault;
  if (leveling == message::LevelingState::kTrainingDrive && state == RobotState::kRunning)
    ++driven_;
}

uint64_t StopCondition::ticks_to_run() const {
  return static_cast<uint64_t>(std::llround(duration_s_ * kTickRate_hz));
}

bool StopCondition::is_over(double time_s) const {
  constexpr double kRounding_s = 1e-9;
  return training_frames_ == 0 &&
         time_s > static_cast<double>(ticks_to_run()) / kTickRate_hz + kRounding_s;
}

bool StopCondition::done() const {
  if (training_frames_ == 0) return ticks_ >= ticks_to_run();
  return driven_ == training_frames_ || ticks_ >= training_frames_ + kMaxIdleTicks;
}

std::optional<RunEnd> StopCondition::reason(bool off_bed) const {
  if (done()) return RunEnd::kDone;
  if (training_frames_ != 0 && fault_) return RunEnd::kFault;
  if (off_bed) return RunEnd::kLeftBed;
  if (stop_ != nullptr && stop_->load(std::memory_order_relaxed)) return RunEnd::kStopped;
  return std::nullopt;
}

double StopCondition::counted_s(double time_s) const {
  return training_frames_ != 0 ? static_cast<double>(driven_) / kTickRate_hz : time_s;
}

}  // namespace screed
