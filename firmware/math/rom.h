// Tables that stay in flash: on the AVR constants are copied into RAM unless they are read in a way
// of their own.
#pragma once

#include <stdint.h>

#ifdef __AVR__
#include <avr/pgmspace.h>
#define SCREED_ROM PROGMEM
#else
#define SCREED_ROM
#endif

namespace screed {

inline uint8_t rom_u8(const uint8_t* at) {
#ifdef __AVR__
  return pgm_read_byte(at);
#else
  return *at;
#endif
}

inline int16_t rom_i16(const int16_t* at) {
#ifdef __AVR__
  return static_cast<int16_t>(pgm_read_word(at));
#else
  return *at;
#endif
}

}  // namespace screed
