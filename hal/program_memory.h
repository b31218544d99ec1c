// Constants that stay in the AVR's flash, and how to read them; on the host they are ordinary
// memory.
#pragma once

#include <stdint.h>

#ifdef __AVR__
#include <avr/pgmspace.h>
#define SCREED_PROGRAM_MEMORY PROGMEM
#else
#define SCREED_PROGRAM_MEMORY
#endif

namespace screed {

inline uint8_t read_program_u8(const uint8_t* address) {
#ifdef __AVR__
  return pgm_read_byte(address);
#else
  return *address;
#endif
}

inline int16_t read_program_i16(const int16_t* address) {
#ifdef __AVR__
  return static_cast<int16_t>(pgm_read_word(address));
#else
  return *address;
#endif
}

inline uint16_t read_program_u16(const uint16_t* address) {
#ifdef __AVR__
  return pgm_read_word(address);
#else
  return *address;
#endif
}

/// Little endian, at any address.
inline uint16_t read_program_u16(const uint8_t* address) {
  return static_cast<uint16_t>(read_program_u8(address) | read_program_u8(address + 1) << 8);
}

/// Little endian, at any address.
inline uint32_t read_program_u32(const uint8_t* address) {
  return static_cast<uint32_t>(read_program_u16(address)) |
         static_cast<uint32_t>(read_program_u16(address + 2)) << 16;
}

}  // namespace screed
