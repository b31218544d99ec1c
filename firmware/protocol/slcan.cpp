// CAN frames as text lines.
#include "firmware/protocol/slcan.h"

#include <string.h>

#include "firmware/math/fixed.h"

namespace screed {
namespace {

constexpr uint8_t kNotHex = 0xFF;
constexpr uint8_t kHeaderLength = 5;  // t, id, size

uint8_t hex_digit(uint8_t value) {
  return static_cast<uint8_t>(value < 10 ? '0' + value : 'A' + (value - 10));
}

uint8_t hex_value(uint8_t digit) {
  const auto decimal = static_cast<uint8_t>(digit - '0');
  if (decimal < 10) return decimal;
  // Small letters and capitals differ in one bit.
  const auto letter = static_cast<uint8_t>((digit | 0x20U) - 'a');
  return letter < 6 ? static_cast<uint8_t>(letter + 10) : kNotHex;
}

}  // namespace

SCREED_OUT_OF_LINE uint8_t* slcan_put_byte(uint8_t* at, uint8_t byte) {
  *at++ = hex_digit(static_cast<uint8_t>(byte >> 4));
  *at++ = hex_digit(byte & 0xFU);
  return at;
}

uint8_t slcan_encode(const CanFrame& frame, uint8_t* line) {
  uint8_t* at = line;
  *at++ = 't';
  // The first digit of the id and the size are one digit alone.
  *at++ = hex_digit((frame.id >> 8) & 0x7U);
  at = slcan_put_byte(at, static_cast<uint8_t>(frame.id & 0xFFU));
  *at++ = hex_digit(frame.size);
  for (uint8_t i = 0; i < frame.size; ++i) at = slcan_put_byte(at, frame.data[i]);
  *at++ = '\r';
  return static_cast<uint8_t>(at - line);
}

bool slcan_byte(const uint8_t* digits, uint8_t& byte) {
  const uint8_t high = hex_value(digits[0]);
  const uint8_t low = hex_value(digits[1]);
  byte = static_cast<uint8_t>((high << 4) | low);
  return high != kNotHex && low != kNotHex;
}

SCREED_OUT_OF_LINE bool SlcanParser::feed(uint8_t byte, CanFrame& frame) {
  if (byte == '\r') return end_line(frame);
  if (state_.length >= kSlcanLineMax - 1) {
    if (state_.length != kSlcanLineMax) ++state_.rejected;
    state_.length = kSlcanLineMax;
    return false;
  }
  if (state_.length == 0) {
    state_.frame_like = byte == 't';
    state_.all_hex = true;
  } else {
    const uint8_t digit = hex_value(byte);
    if (digit == kNotHex) state_.all_hex = false;
    uint8_t& digits = state_.digits[static_cast<uint8_t>(state_.length - 1) / 2U];
    digits = static_cast<uint8_t>(static_cast<uint8_t>(digits << 4) | digit);
  }
  ++state_.length;
  return false;
}

bool SlcanParser::end_line(CanFrame& frame) {
  const uint8_t length = state_.length;
  state_.length = 0;
  if (length == 0 || length == kSlcanLineMax || !state_.frame_like) return false;
  const auto size = static_cast<uint8_t>(state_.digits[1] & 0xFU);
  if (!state_.all_hex || (state_.digits[0] & 0x80U) != 0 || size > sizeof(frame.data) ||
      length != static_cast<uint8_t>(kHeaderLength + 2 * size)) {
    ++state_.rejected;
    return false;
  }
  frame.id = static_cast<uint16_t>(state_.digits[0] << 4 | state_.digits[1] >> 4);
  frame.size = size;
  memcpy(frame.data, state_.digits + 2, size);
  return true;
}

}  // namespace screed
