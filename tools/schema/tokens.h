// The words of a DBC file, each with its line.
#pragma once

#include <string>
#include <vector>

namespace screed::schema {

struct Token {
  enum class Kind { kWord, kNumber, kString, kSign, kEnd };
  Kind kind = Kind::kEnd;
  std::string text;  ///< of a string: what is between the quotation marks
  int line = 0;
};

/// Cuts a text into tokens; the last one is kEnd. A sign is one character. Throws InputError
/// "FILE:LINE: what" at a string without an end or a character that no token begins with.
std::vector<Token> tokens_of(const std::string& file, const std::string& text);

}  // namespace screed::schema
