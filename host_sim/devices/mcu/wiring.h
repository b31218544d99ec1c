// What is connected to which pin of the microcontroller, as boards/<board>/wiring.ini says it: the
// hardware the simulation builds. The firmware has its own description (pins.h); a mistake in one
// of the two shows.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "host_sim/devices/mcu/mcu.h"

namespace screed::mcu {

struct Wiring {
  struct Motor {
    PinName pwm;        ///< PB5 (OC1A) or PB6 (OC1B)
    PinName direction;  ///< high: reverse
  };
  struct Encoder {
    PinName a;  ///< with xored wiring: A xor B
    PinName b;
  };
  struct Led {
    PinName pin;
    bool lit_high;
  };
  struct Axis {
    std::uint8_t index;  ///< of the chips
    bool reversed;
  };

  std::array<Motor, 2> motors;  ///< left, right
  std::array<Encoder, 2> encoders;
  bool xored = false;
  std::array<Led, 3> leds;  ///< in the order of LedBit: yellow, green, red
  int adc_channel = 0;
  double battery_divider = 1.0;
  bool has_barometer = false;
  std::array<Axis, 3> axes;  ///< the robot's x, y, z
};

/// Throws InputError: missing file, unknown or missing key, wrong value, naming file and line.
Wiring read_wiring(const std::filesystem::path& path);

}  // namespace screed::mcu
