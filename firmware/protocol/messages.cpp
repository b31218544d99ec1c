// Packing of values that do not fill whole bytes.
#include "firmware/protocol/messages.h"

#include "firmware/math/fixed.h"

namespace screed {
namespace {

/// The sign of a 12-bit number, extended.
int16_t from_12_bits(uint16_t bits) {
  return static_cast<int16_t>(bits & 0x800U ? bits | 0xF000U : bits);
}

}  // namespace

void put_drive_argument(uint8_t* at, const DriveArgument& argument) {
  const uint16_t speed = static_cast<uint16_t>(argument.speed_mm_per_s) & 0xFFFU;
  const uint16_t turn = static_cast<uint16_t>(argument.turn_ddeg_per_s) & 0xFFFU;
  at[0] = static_cast<uint8_t>(speed & 0xFFU);
  at[1] = static_cast<uint8_t>((speed >> 8) | ((turn & 0xFU) << 4));
  at[2] = static_cast<uint8_t>(turn >> 4);
}

DriveArgument get_drive_argument(const uint8_t* at) {
  const uint16_t speed = static_cast<uint16_t>(at[0] | static_cast<uint16_t>((at[1] & 0xFU) << 8));
  return {from_12_bits(speed), asr_i16(get_s16(at + 1), 4)};
}

}  // namespace screed
