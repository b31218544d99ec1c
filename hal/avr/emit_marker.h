// Writes the marks of trace_markers.h.
#pragma once

#include <avr/io.h>

#include "hal/avr/trace_markers.h"

namespace screed {
namespace avr {

inline void emit_marker(TraceMarker what, const void* where) {
  // The compiler may not keep a part of the object in registers here.
  asm volatile("" : : "r"(where) : "memory");
  const uint16_t address = reinterpret_cast<uint16_t>(where);
  GPIOR1 = static_cast<uint8_t>(address & 0xFFU);
  GPIOR2 = static_cast<uint8_t>(address >> 8);
  GPIOR0 = what;
}

}  // namespace avr
}  // namespace screed
