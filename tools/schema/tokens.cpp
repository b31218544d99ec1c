// The words of a DBC file.
#include "tools/schema/tokens.h"

#include <cctype>
#include <string_view>

#include "host_sim/core/errors.h"

namespace screed::schema {
namespace {

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}
bool begins_word(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool in_word(char c) {
  return begins_word(c) || is_digit(c);
}

}  // namespace

std::vector<Token> tokens_of(const std::string& file, const std::string& text) {
  std::vector<Token> tokens;
  int line = 1;
  size_t at = 0;
  const auto take_while = [&](auto&& belongs) {
    const size_t begin = at;
    while (at < text.size() && belongs(text[at])) ++at;
    return text.substr(begin, at - begin);
  };
  const auto fail = [&](const std::string& what) {
    throw InputError(file + ":" + std::to_string(line) + ": " + what);
  };
  while (at < text.size()) {
    const char c = text[at];
    if (c == '\n') {
      ++line;
      ++at;
    } else if (c == ' ' || c == '\t' || c == '\r') {
      ++at;
    } else if (begins_word(c)) {
      tokens.push_back({Token::Kind::kWord, take_while(in_word), line});
    } else if (is_digit(c) || ((c == '-' || c == '+') && at + 1 < text.size() &&
                               is_digit(text[at + 1]) && (at == 0 || !is_digit(text[at - 1])))) {
      std::string number(1, text[at++]);
      number += take_while([](char d) { return is_digit(d) || d == '.'; });
      if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
        number += text[at++];
        if (at < text.size() && (text[at] == '-' || text[at] == '+')) number += text[at++];
        number += take_while(is_digit);
      }
      tokens.push_back({Token::Kind::kNumber, number, line});
    } else if (c == '"') {
      const int begin_line = line;
      ++at;
      std::string words;
      while (at < text.size() && text[at] != '"') {
        if (text[at] == '\n') ++line;
        words += text[at++];
      }
      if (at == text.size()) {
        line = begin_line;
        fail("this string has no end");
      }
      ++at;
      tokens.push_back({Token::Kind::kString, words, begin_line});
    } else if (std::string_view(":;|@+-(),[]").find(c) != std::string_view::npos) {
      tokens.push_back({Token::Kind::kSign, std::string(1, c), line});
      ++at;
    } else {
      fail(std::isprint(static_cast<unsigned char>(c)) != 0
               ? "the character '" + std::string(1, c) + "' is not allowed here"
               : "a byte that is not text (" + std::to_string(static_cast<unsigned char>(c)) + ")");
    }
  }
  tokens.push_back({Token::Kind::kEnd, "the end of the file", line});
  return tokens;
}

}  // namespace screed::schema
