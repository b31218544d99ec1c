// Names and numbers as the generated code writes them.
#include "tools/schema/code_text.h"

#include <cctype>
#include <cstdio>

namespace screed::schema {

std::string pascal_case(const std::string& name) {
  std::string out;
  bool first = true;
  for (const char c : name) {
    if (c == '_') {
      first = true;
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    out += static_cast<char>(first ? std::toupper(byte) : std::tolower(byte));
    first = false;
  }
  return out;
}

std::string capitals(std::string name) {
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

std::string small_letters(std::string name) {
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

std::string id_text(std::uint32_t id) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%03X", static_cast<unsigned>(id));
  return text;
}

std::string unsigned_type(int bits) {
  return bits <= 8 ? "uint8_t" : bits <= 16 ? "uint16_t" : "uint32_t";
}

std::string made_from(const Database& database) {
  return "Made from " + database.file + " by tools/schema: change that file, not this one.";
}

}  // namespace screed::schema
