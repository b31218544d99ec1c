// Parameters of the firmware by their names.
#include "tools/screed/cli/parameter_names.h"

#include <charconv>

#include "firmware/parameters/parameter_table.h"
#include "host_sim/core/errors.h"

namespace screed {

uint16_t parameter_index(const std::string& name) {
  std::string names;
  uint16_t index = 0;
  for (const ParameterInfo& info : kParameterTable) {
    if (name == info.name) return index;
    names += (names.empty() ? "" : ", ") + std::string(info.name);
    ++index;
  }
  throw InputError("unknown parameter '" + name + "'; known are " + names);
}

int16_t parameter_value(uint16_t index, const std::string& text) {
  const ParameterInfo& info = kParameterTable[index];
  int16_t value = 0;
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || value < info.min || value > info.max) {
    throw InputError(std::string(info.name) + " = '" + text +
                     "' is not allowed; expected an integer " + std::to_string(info.min) + ".." +
                     std::to_string(info.max) + (*info.unit == '\0' ? "" : " ") + info.unit);
  }
  return value;
}

}  // namespace screed
