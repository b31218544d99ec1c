// What a network of motion may see of a robot and of its ground, by the names that model files use
// for their inputs. Units are those of nn/data/features.h: displacements and turns are of one frame
// of 10 ms.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace screed::nn {

enum class MotionSignal : std::uint8_t {
  kForward1,
  kSideways1,
  kTurn1,
  kTrackLeft,
  kTrackRight,
  kWheelLeft,
  kWheelRight,
  kPitch,
  kRoll,
  kSpeed,
  kSpin,
  kClimb,
  kLean,
  kSlide,
  kPivot,
};
inline constexpr std::size_t kMotionSignals = 15;

struct MotionSignalInfo {
  MotionSignal signal;
  const char* name;
  const char* unit;
  const char* meaning;
};

/// Every signal, in the order of the enumeration.
std::span<const MotionSignalInfo> motion_signals();
std::optional<MotionSignal> motion_signal_named(std::string_view name);

constexpr std::size_t row_of(MotionSignal signal) {
  return static_cast<std::size_t>(signal);
}

}  // namespace screed::nn
