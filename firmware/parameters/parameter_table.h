// The parameter table as text, for hosts: names, units, ranges and meanings for experiment files
// and listings. Not for the MCU image, which has no room for the strings.
#pragma once

#include "firmware/parameters/parameters.h"

namespace screed {

struct ParameterInfo {
  uint8_t number;
  const char* name;
  const char* unit;
  int16_t min;
  int16_t max;
  int16_t default_value;
  const char* meaning;
};

/// By their numbers. Defined in parameters.cpp, so that texts and ranges, which grow with the
/// algorithms, are compiled once.
extern const ParameterInfo kParameterTable[Parameters::kCount];

}  // namespace screed
