// CAN frames as text lines.
#include "firmware/protocol/slcan.h"

#include <stddef.h>

namespace screed {
namespace {

constexpr uint8_t kNotHex = 0xFF;

uint8_t hex_digit(uint8_t value) {
  return static_cast<uint8_t>(value < 10 ? '0' + value : 'A' + (value - 10));
}

uint8_t hex_value(uint8_t digit) {
  if (digit >= '0' && digit <= '9') return static_cast<uint8_t>(digit - '0');
  if (digit >= 'A' && digit <= 'F') return static_cast<uint8_t>(digit - 'A' + 10);
  if (digit >= 'a' && digit <= 'f') return static_cast<uint8_t>(digit - 'a' + 10);
  return kNotHex;
}

}  // namespace

uint8_t slcan_encode(const CanFrame& frame, uint8_t* line) {
  uint8_t at = 0;
  line[at++] = 't';
  line[at++] = hex_digit((frame.id >> 8) & 0x7U);
  line[at++] = hex_digit((frame.id >> 4) & 0xFU);
  line[at++] = hex_digit(frame.id & 0xFU);
  line[at++] = hex_digit(frame.size);
  for (uint8_t i = 0; i < frame.size; ++i) {
    line[at++] = hex_digit(static_cast<uint8_t>(frame.data[i] >> 4));
    line[at++] = hex_digit(frame.data[i] & 0xFU);
  }
  line[at++] = '\r';
  return at;
}

bool slcan_byte(const uint8_t* digits, uint8_t& byte) {
  const uint8_t high = hex_value(digits[0]);
  const uint8_t low = hex_value(digits[1]);
  byte = static_cast<uint8_t>((high << 4) | low);
  return high != kNotHex && low != kNotHex;
}

bool SlcanParser::feed(uint8_t byte, CanFrame& frame) {
  if (byte != '\r') {
    if (length_ < sizeof(line_)) {
      line_[length_++] = byte;
    } else if (!too_long_) {
      too_long_ = true;
      ++rejected_;
    }
    return false;
  }
  const bool frame_like = length_ > 0 && line_[0] == 't';
  const bool good = frame_like && !too_long_ && decode(frame);
  if (frame_like && !too_long_ && !good) ++rejected_;
  length_ = 0;
  too_long_ = false;
  return good;
}

bool SlcanParser::decode(CanFrame& frame) const {
  if (length_ < 5) return false;
  uint8_t nibbles[4] = {0, 0, 0, 0};
  for (uint8_t i = 0; i < 4; ++i) {
    nibbles[i] = hex_value(line_[i + 1]);
    if (nibbles[i] == kNotHex) return false;
  }
  if (nibbles[0] > 7 || nibbles[3] > 8) return false;
  if (length_ != 5 + 2 * nibbles[3]) return false;
  frame.id = static_cast<uint16_t>((nibbles[0] << 8) | (nibbles[1] << 4) | nibbles[2]);
  frame.size = nibbles[3];
  for (uint8_t i = 0; i < frame.size; ++i) {
    if (!slcan_byte(line_ + 5 + size_t{2} * i, frame.data[i])) return false;
  }
  return true;
}

}  // namespace screed
