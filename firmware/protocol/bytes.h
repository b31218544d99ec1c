// Numbers as little-endian bytes.
#pragma once

#include <stdint.h>

namespace screed {

inline void put_u16(uint8_t* at, uint16_t value) {
  at[0] = static_cast<uint8_t>(value & 0xFFU);
  at[1] = static_cast<uint8_t>(value >> 8);
}
inline void put_s16(uint8_t* at, int16_t value) {
  put_u16(at, static_cast<uint16_t>(value));
}
inline void put_u32(uint8_t* at, uint32_t value) {
  put_u16(at, static_cast<uint16_t>(value & 0xFFFFU));
  put_u16(at + 2, static_cast<uint16_t>(value >> 16));
}
inline void put_s32(uint8_t* at, int32_t value) {
  put_u32(at, static_cast<uint32_t>(value));
}
inline uint16_t get_u16(const uint8_t* at) {
  return static_cast<uint16_t>(at[0] | static_cast<uint16_t>(static_cast<uint16_t>(at[1]) << 8));
}
inline int16_t get_s16(const uint8_t* at) {
  return static_cast<int16_t>(get_u16(at));
}
inline uint32_t get_u32(const uint8_t* at) {
  return get_u16(at) | static_cast<uint32_t>(get_u16(at + 2)) << 16;
}
inline int32_t get_s32(const uint8_t* at) {
  return static_cast<int32_t>(get_u32(at));
}

}  // namespace screed
