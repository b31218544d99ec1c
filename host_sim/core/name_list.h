// Lists of names in messages and help texts.
#pragma once

#include <string>
#include <vector>

namespace screed {

/// "a, b, c"; with another `last`, " or ": "a, b or c".
inline std::string name_list(const std::vector<std::string>& names, const char* last = ", ") {
  std::string text;
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? last : ", ";
    text += names[i];
  }
  return text;
}

}  // namespace screed
