// CAN frames as text lines (SLCAN, Lawicel): tIIIL<hex>\r. Knows lines and frames, not what they
// mean.
#pragma once

#include <stdint.h>

namespace screed {

struct CanFrame {
  uint16_t id;   ///< 11 bits
  uint8_t size;  ///< 0..8
  uint8_t data[8];
};

/// Characters of the longest line, its end included: t, three digits of id, one of size, 16 of
/// data, \r.
constexpr uint8_t kSlcanLineMax = 22;

/// Writes the line of a frame; returns its length (6..22). `line` has room for kSlcanLineMax
/// characters; no final 0.
uint8_t slcan_encode(const CanFrame& frame, uint8_t* line);

/// Writes a byte as two hexadecimal digits, upper case; returns what follows them.
uint8_t* slcan_put_byte(uint8_t* at, uint8_t byte);

/// The byte of two hexadecimal digits; false when they are none.
bool slcan_byte(const uint8_t* digits, uint8_t& byte);

/// Collects bytes to lines and lines to frames. A line that is not exactly a data frame (other
/// commands, wrong length, foreign characters, too long) is dropped; rejected() counts those that
/// began like a frame, and those that are too long to be anything.
class SlcanParser {
 public:
  SlcanParser() {}

  /// Takes one byte. Returns true when it ended a well-formed frame, which is then in `frame`.
  bool feed(uint8_t byte, CanFrame& frame);

  /// Lines counted as rejected, wraps.
  uint8_t rejected() const { return state_.rejected; }

 private:
  /// What the parser remembers, zero at the start.
  struct State {
    uint8_t digits[kSlcanLineMax / 2 - 1];  ///< of id, size and data, two a byte
    uint8_t length;                         ///< of the line so far; kSlcanLineMax: too long
    bool frame_like;
    bool all_hex;
    uint8_t rejected;
  };

  bool end_line(CanFrame& frame);

  State state_{};
};

}  // namespace screed
