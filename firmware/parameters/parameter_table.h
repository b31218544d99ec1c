// The parameter table as text, for hosts: names, units, ranges and meanings for experiment files
// and listings. Not for the MCU image, which has no room for the strings.
#pragma once

#include "firmware/parameters/algorithms_in_build.h"
#include "firmware/parameters/parameters.h"

namespace screed {

struct ParameterInfo {
  const char* name;
  const char* unit;
  int16_t min;
  int16_t max;
  int16_t default_value;
  const char* meaning;
  int16_t Parameters::*field;
};

constexpr ParameterInfo kParameterTable[] = {
#define SCREED_INFO(name, unit, min, max, value, meaning) \
  {#name, unit, min, max, value, meaning, &Parameters::name},
    SCREED_PARAMETERS(SCREED_INFO)
#undef SCREED_INFO
};

}  // namespace screed
