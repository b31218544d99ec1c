// End-to-end protection of a frame: AUTOSAR E2E Profile 2. Byte 0 is a CRC-8 (polynomial 0x2F,
// initial and final xor 0xFF) over bytes 1..7 and a data id; the low half of byte 1 is an alive
// counter 0..15.
//
// Source: AUTOSAR "Specification of SW-C End-to-End Communication Protection Library", profile 2.
#pragma once

#include <stdint.h>

namespace screed {

/// CRC-8H2F of `size` bytes, continuing from `crc` (start with 0xFF, xor the end with 0xFF).
uint8_t crc8_h2f(uint8_t crc, const uint8_t* data, uint8_t size);

/// The data id of a CAN id: makes a frame that was delivered under another id fail its check.
///
/// The three bits above the lower byte are folded in so that they act on the CRC like bits of the
/// data that no other bit acts like: up to three wrong bits anywhere in id, data and CRC are found,
/// as the polynomial promises for the data alone. The standard's list of a data id for each
/// counter value holds 16 times the same one: were they different, a wrong digit of the counter
/// would change data and data id together, and some of those changes cancel out.
constexpr uint8_t e2e_data_id(uint16_t can_id) {
  return static_cast<uint8_t>(can_id ^ (can_id >> 8) ^ (can_id >> 7 & 0x0EU) ^
                              (can_id >> 5 & 0x38U));
}

/// Byte 0 of a protected frame: the CRC over data[1..size) and a data id (in the standard:
/// DataIDList[counter]). size 2..8; data[1] holds the counter already.
uint8_t e2e_crc(uint8_t data_id, const uint8_t* data, uint8_t size);

/// Writes counter (0..15) and CRC into data[0..size); size 3..8. Bits 4..7 of data[1] are left to
/// the message.
void e2e_protect(uint16_t can_id, uint8_t counter, uint8_t* data, uint8_t size);

/// True when the CRC is right for this id and size. A frame of the header alone (size 2) says
/// nothing and is refused.
bool e2e_check(uint16_t can_id, const uint8_t* data, uint8_t size);

}  // namespace screed
