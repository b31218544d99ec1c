// What a network of motion may see of a robot and of its ground, by the names that model files use
// for their inputs. Units are those of nn/data/features.h: displacements and turns are of one frame
// of 10 ms.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "host_sim/physics/soil/soil_parameters.h"

namespace screed::nn {

enum class MotionSignal : std::uint8_t {
  kForward1,
  kSideways1,
  kTurn1,
  kForward2,
  kSideways2,
  kTurn2,
  kTrackLeft,
  kTrackRight,
  kTrackLeft1,
  kTrackRight1,
  kTrackLeft2,
  kTrackRight2,
  kForwardSettling,
  kSidewaysSettling,
  kTurnSettling,
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
  kSoilStiffness,
  kSoilExponent,
  kSoilCohesion,
  kSoilFriction,
  kSoilShear,
  kSoilSinkage,
};
inline constexpr std::size_t kMotionSignals = 31;

struct MotionSignalInfo {
  MotionSignal signal;
  const char* name;
  const char* unit;
  const char* meaning;
};

/// Every signal, in the order of the enumeration.
std::span<const MotionSignalInfo> motion_signals();
std::optional<MotionSignal> motion_signal_named(std::string_view name);

inline constexpr std::size_t kSoilSignals = 6;
inline constexpr MotionSignal kFirstSoilSignal = MotionSignal::kSoilStiffness;
/// A soil as networks see it: kSoilSignals numbers from kFirstSoilSignal on.
std::array<double, kSoilSignals> soil_signals(const SoilParameters& soil);

constexpr std::size_t row_of(MotionSignal signal) {
  return static_cast<std::size_t>(signal);
}

}  // namespace screed::nn
