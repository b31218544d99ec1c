// What a robot authenticates commands with. Comes from its EEPROM, or from the experiment in a
// simulation; constant while the program runs.
#pragma once

#include <stdint.h>

#include "firmware/security/siphash.h"

namespace screed {

struct Credentials {
  uint8_t key[kSipHashKeySize];
  uint8_t robot_id;     ///< stands behind the key; tells robots with the same key apart
  bool key_set;         ///< false: no key, or a damaged one; no command is accepted
  uint16_t boot_epoch;  ///< number of this start, 1..65535; never the same twice
};

}  // namespace screed
