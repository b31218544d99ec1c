#include "nn/data/signals.h"

#include <cmath>
#include <numbers>

namespace screed::nn {
namespace {

constexpr SignalInfo kTable[kSignals] = {
    {Signal::kForward1, "forward@1", "m/frame", "way along the heading, a frame ago"},
    {Signal::kSideways1, "sideways@1", "m/frame", "way to the left of it, a frame ago"},
    {Signal::kTurn1, "delta_theta@1", "rad/frame", "change of heading, a frame ago"},
    {Signal::kForward2, "forward@2", "m/frame", "two frames ago"},
    {Signal::kSideways2, "sideways@2", "m/frame", "two frames ago"},
    {Signal::kTurn2, "delta_theta@2", "rad/frame", "two frames ago"},
    {Signal::kTrackLeft, "track_left", "m/s", "left track over its wheels, at the frame's end"},
    {Signal::kTrackRight, "track_right", "m/s", "right track, at the frame's end"},
    {Signal::kTrackLeft1, "track_left@1", "m/s", "left track, at the frame's beginning"},
    {Signal::kTrackRight1, "track_right@1", "m/s", "right track, at the frame's beginning"},
    {Signal::kTrackLeft2, "track_left@2", "m/s", "left track, a frame before that"},
    {Signal::kTrackRight2, "track_right@2", "m/s", "right track, a frame before that"},
    {Signal::kForwardSettling, "forward_settling", "m/frame",
     "way forward as it would swing towards that of slipping tracks (surrogate.h)"},
    {Signal::kSidewaysSettling, "sideways_settling", "m/frame", "way to the left, likewise"},
    {Signal::kTurnSettling, "delta_theta_settling", "rad/frame", "change of heading, likewise"},
    {Signal::kWheelLeft, "v_left", "rad/s", "left drive wheel: the track's speed over its radius"},
    {Signal::kWheelRight, "v_right", "rad/s", "right drive wheel"},
    {Signal::kPitch, "pitch", "rad", "of the ground under the tracks, nose up positive"},
    {Signal::kRoll, "roll", "rad", "of the ground under the tracks, left side up positive"},
    {Signal::kSpeed, "speed", "rad/s", "amount of the mean of both drive wheels"},
    {Signal::kSpin, "spin", "rad/s", "amount of their difference"},
    {Signal::kClimb, "climb", "rad/s", "sin pitch times the wheels' mean: > 0 uphill"},
    {Signal::kLean, "lean", "rad/s", "sin roll times the wheels' difference, right less left"},
    {Signal::kSlide, "slide", "rad/s", "sin roll times the wheels' mean"},
    {Signal::kPivot, "pivot", "rad/s", "sin pitch times the wheels' difference"},
    {Signal::kSoilStiffness, "soil_stiffness", "log10 N/m^(n+2)", "k_c / b + k_phi of Bekker"},
    {Signal::kSoilExponent, "soil_exponent", "", "n of Bekker"},
    {Signal::kSoilCohesion, "soil_cohesion", "Pa", "c of Coulomb"},
    {Signal::kSoilFriction, "soil_friction", "", "tan phi of Coulomb"},
    {Signal::kSoilShear, "soil_shear", "m", "K of Janosi and Hanamoto"},
    {Signal::kSoilSinkage, "soil_sinkage", "log10 m", "depth at which the soil bears 6 kPa"},
};

constexpr double kTrackWidth_m = 0.03;  // b of Bekker under a track
constexpr double kPressure_pa = 6e3;    // the robot's weight under a third of its tracks

}  // namespace

std::span<const SignalInfo> signals() {
  return kTable;
}

std::optional<Signal> signal_named(std::string_view name) {
  for (const SignalInfo& info : kTable) {
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
