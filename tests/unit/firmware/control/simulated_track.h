// One motor with its track and encoder as a first-order lag, for tests of the speed loops: the
// speed follows the voltage with a time constant, the encoder counts whole steps.
#pragma once

#include <cmath>
#include <cstdint>

namespace screed {

struct SimulatedTrack {
  double full_speed_mm_per_s = 250.0;  ///< at full duty and 7.2 V
  double time_constant_s = 0.05;
  double mm_per_count = 9048.0 / 16000.0;

  double speed_mm_per_s = 0.0;
  double travel_mm = 0.0;

  /// Advances one tick of 10 ms; returns the encoder counts of that time.
  int16_t step(int16_t duty, double battery_v = 7.2, double load_mm_per_s = 0.0) {
    double aim = full_speed_mm_per_s * duty / 400.0 * battery_v / 7.2;
    // The load holds the track until the motor overcomes it.
    aim = std::abs(aim) > load_mm_per_s ? aim - std::copysign(load_mm_per_s, aim) : 0.0;
    speed_mm_per_s += (aim - speed_mm_per_s) * (1.0 - std::exp(-0.01 / time_constant_s));
    const double before = std::floor(travel_mm / mm_per_count);
    travel_mm += speed_mm_per_s * 0.01;
    return static_cast<int16_t>(std::floor(travel_mm / mm_per_count) - before);
  }
};

}  // namespace screed
