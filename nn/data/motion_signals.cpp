#include "nn/data/motion_signals.h"

#include <cmath>
#include <numbers>

namespace screed::nn {
namespace {

constexpr MotionSignalInfo kTable[kMotionSignals] = {
    {MotionSignal::kForward1, "forward@1", "m/frame",
     "displacement along the heading, a frame ago"},
    {MotionSignal::kSideways1, "sideways@1", "m/frame",
     "displacement to the left of it, a frame ago"},
    {MotionSignal::kTurn1, "delta_theta@1", "rad/frame", "change of heading, a frame ago"},
    {MotionSignal::kForward2, "forward@2", "m/frame", "two frames ago"},
    {MotionSignal::kSideways2, "sideways@2", "m/frame", "two frames ago"},
    {MotionSignal::kTurn2, "delta_theta@2", "rad/frame", "two frames ago"},
    {MotionSignal::kTrackLeft, "track_left", "m/s",
     "left track over its wheels, at the frame's end"},
    {MotionSignal::kTrackRight, "track_right", "m/s", "right track, at the frame's end"},
    {MotionSignal::kTrackLeft1, "track_left@1", "m/s", "left track, at the frame's beginning"},
    {MotionSignal::kTrackRight1, "track_right@1", "m/s", "right track, at the frame's beginning"},
    {MotionSignal::kTrackLeft2, "track_left@2", "m/s", "left track, a frame before that"},
    {MotionSignal::kTrackRight2, "track_right@2", "m/s", "right track, a frame before that"},
    {MotionSignal::kForwardSettling, "forward_settling", "m/frame",
     "displacement forward as it would settle towards that of slipping tracks (surrogate.h)"},
    {MotionSignal::kSidewaysSettling, "sideways_settling", "m/frame",
     "displacement to the left, likewise"},
    {MotionSignal::kTurnSettling, "delta_theta_settling", "rad/frame",
     "change of heading, likewise"},
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
    {MotionSignal::kSoilStiffness, "soil_stiffness", "log10 N/m^(n+2)",
     "k_c / b + k_phi of Bekker"},
    {MotionSignal::kSoilExponent, "soil_exponent", "", "n of Bekker"},
    {MotionSignal::kSoilCohesion, "soil_cohesion", "Pa", "c of Coulomb"},
    {MotionSignal::kSoilFriction, "soil_friction", "", "tan phi of Coulomb"},
    {MotionSignal::kSoilShear, "soil_shear", "m", "K of Janosi and Hanamoto"},
    {MotionSignal::kSoilSinkage, "soil_sinkage", "log10 m", "sinkage at 6 kPa"},
};

constexpr double kTrackWidth_m = 0.03;  // b of Bekker under a track
constexpr double kPressure_pa = 6e3;    // the robot's weight under a third of its tracks

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

std::array<double, kSoilSignals> soil_signals(const SoilParameters& soil) {
  const double stiffness = soil.k_c / kTrackWidth_m + soil.k_phi;
  return {std::log10(stiffness), soil.exponent,
          soil.cohesion_pa,      std::tan(soil.friction_deg * std::numbers::pi / 180.0),
          soil.shear_modulus_m,  std::log10(kPressure_pa / stiffness) / soil.exponent};
}

}  // namespace screed::nn
