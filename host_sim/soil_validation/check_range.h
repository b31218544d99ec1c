// Refuses a figure out of its range with one clear line.
#pragma once

#include <cstdio>
#include <string>

#include "host_sim/core/errors.h"

namespace screed {

/// Throws InputError unless low <= value <= high (so for what is no number, too).
inline void check_range(const char* what, const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  char text[160];
  std::snprintf(text, sizeof text, "%s: %s = %g; allowed is %g to %g", what, name, value, low,
                high);
  throw InputError(text);
}

}  // namespace screed
