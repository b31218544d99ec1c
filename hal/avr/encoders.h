// Both track encoders, counted by pin interrupts.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

struct EncoderCounts {
  uint16_t left;   ///< wraps; rises when the left track drives forward
  uint16_t right;  ///< as left
  uint8_t errors;  ///< missed edges of both, and floods of edges, wraps
};

void encoders_init();

/// Both counts of one moment. A flood of edges is cut off until then, and counts as an error.
EncoderCounts encoders_read();

}  // namespace avr
}  // namespace screed
