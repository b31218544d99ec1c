#include "nn/data/motion_signals.h"

namespace screed::nn {
namespace {

constexpr MotionSignalInfo kTable[kMotionSignals] = {
    {MotionSignal::kForward1, "forward@1", "m/frame",
     "displacement along the heading, a frame ago"},
    {MotionSignal::kSideways1, "sideways@1", "m/frame",
     "displacement to the left of it, a frame ago"},
    {MotionSignal::kTurn1, "delta_theta@1", "rad/frame", "change of heading, a frame ago"},
    {MotionSignal::kTrackLeft, "track_left", "m/s",
     "left track over its wheels, at the frame's end"},
    {MotionSignal::kTrackRight, "track_right", "m/s", "right track, at the frame's end"},
    {MotionSignal::kWheelLeft, "v_left", "rad/s",
     "left drive wheel: the track's speed over its radius"},
    {MotionSignal::kWheelRight, "v_right", "rad/s", "right drive wheel"},
    {MotionSignal::kPitch, "pitch", "rad", "of the ground under the tracks, nose up positive"},
    {MotionSignal::kRoll, "roll", "rad", "of the ground under the tracks, left side up positive"},
    {MotionSignal::kSpeed, "speed", "rad/s", "absolute value of the mean of both drive wheels"},
    {MotionSignal::kSpin, "spin", "rad/s", "absolute value of their difference"},
    {MotionSignal::kClimb, "climb", "rad/s", "sin pitch times the wheels' mean: > 0 uphill"},
    {MotionSignal::kLean, "lean", "rad/s",
     "sin roll times the wheels' difference, right less left"},
    {MotionSignal::kSlide, "slide", "rad/s", "sin roll times the wheels' mean"},
    {MotionSignal::kPivot, "pivot", "rad/s", "sin pitch times the wheels' difference"},
};

}  // namespace

std::span<const MotionSignalInfo> motion_signals() {
  return kTable;
}

std::optional<MotionSignal> motion_signal_named(std::string_view name) {
  for (const MotionSignalInfo& info : kTable) {
    if (name == info.name) return info.signal;
  }
  return std::nullopt;
}

}  // namespace screed::nn
