// Decoding of a quadrature encoder: two channels, a quarter period apart. Knows no pins; runs on
// any machine.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

/// Levels of both channels.
struct QuadratureLevels {
  bool a;
  bool b;
};

/// Wiring with (A xor B) on one pin, as on boards with one interrupt pin a side: A = XOR ^ B.
constexpr QuadratureLevels levels_from_xor(bool xor_level, bool b) {
  return {xor_level != b, b};
}

struct Quadrature {
  uint16_t count;  ///< state changes, wraps; rises when A leads B
  uint8_t errors;  ///< both channels changed at once: an edge was missed; wraps
  QuadratureLevels last;

  void start(QuadratureLevels levels) { last = levels; }

  void update(QuadratureLevels now) {
    const bool ahead = now.a != last.b;
    const bool behind = last.a != now.b;
    if (ahead && !behind) ++count;
    if (behind && !ahead) --count;
    if (now.a != last.a && now.b != last.b) ++errors;
    last = now;
  }
};

}  // namespace avr
}  // namespace screed
