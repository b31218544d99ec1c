// Climbs straight on and spins once the decline begins.
#include "firmware/leveling/spin_on_peak.h"

namespace screed {
namespace {

// A climb that meets neither decline nor incline for this long has reached a plateau, not a peak.
constexpr uint16_t kPlateauTicks = 3 * kTickRate_hz;

}  // namespace

SpinOnPeak::SpinOnPeak(const Parameters& parameters)
    : spin_rate_(yaw_rate_from_degrees(parameters.spin_rate())),
      spin_ticks_(ticks_from_ms(parameters.spin_time())) {}

SCREED_OUT_OF_LINE MotionCommand SpinOnPeak::spin(Behaviour& behaviour) const {
  const YawRate rate = spin_left_ ? spin_rate_ : static_cast<YawRate>(-spin_rate_);
  return behaviour.enter_or_stay(LevelingState::kSpin, {0, rate});
}

MotionCommand SpinOnPeak::tick(const LevelingInput& input, Behaviour& behaviour) {
  switch (behaviour.state()) {
    case LevelingState::kSpin:
      return behaviour.ticks_in_state() < spin_ticks_ ? spin(behaviour) : behaviour.walk();
    case LevelingState::kClimb:
      if (behaviour.downhill(input)) {
        spin_left_ = !spin_left_;
        return spin(behaviour);
      }
      if (behaviour.uphill(input)) behaviour.restart_time();
      return behaviour.ticks_in_state() < kPlateauTicks ? behaviour.climb(input) : behaviour.walk();
    default:
      return behaviour.uphill(input) ? behaviour.climb(input) : behaviour.walk();
  }
}

}  // namespace screed
