// A lexer for what the mutation operators need.
#include "tools/mutants/tokens.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace screed::mutants {
namespace {

constexpr std::array<std::string_view, 26> kSigns{
    "<<=", ">>=", "->*", "...", "<=>", "::", "->", "++", "--", "<<", ">>", "<=", ">=",
    "==",  "!=",  "&&",  "||",  "+=",  "-=", "*=", "/=", "%=", "&=", "|=", "^=", "##"};

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}
bool is_space(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

/// Behind the quoted text that begins at `at`.
std::size_t behind_quote(std::string_view source, std::size_t at) {
  const char quote = source[at];
  for (++at; at < source.size() && source[at] != quote; ++at) {
    if (source[at] == '\\') ++at;
  }
  return std::min(at + 1, source.size());
}

std::size_t behind_raw_text(std::string_view source, std::size_t quote) {
  const std::size_t open = source.find('(', quote);
  if (open == std::string_view::npos) return source.size();
  const std::string close = ")" + std::string(source.substr(quote + 1, open - quote - 1)) + "\"";
  const std::size_t end = source.find(close, open);
  return end == std::string_view::npos ? source.size() : end + close.size();
}

std::size_t line_end(std::string_view source, std::size_t at) {
  while (at < source.size() && source[at] != '\n') {
    if (source[at] == '\\') ++at;
    ++at;
  }
  return std::min(at, source.size());
}

/// The line that ends the branch which begins at `at`: #else, #elif or #endif.
std::size_t branch_end(std::string_view source, std::size_t at) {
  int depth = 0;
  const auto next_line = [&] { return source.find_first_not_of(" \n", line_end(source, at)); };
  for (at = next_line(); at != std::string_view::npos; at = next_line()) {
    if (source[at] != '#') continue;
    const std::string_view word = source.substr(at + 1, 5);
    if (depth == 0 && (word.starts_with("el") || word == "endif")) return at;
    if (word.starts_with("if")) ++depth;
    if (word == "endif") --depth;
  }
  return source.size();
}

/// Behind the comment or preprocessor line at `at`, and behind what only the microcontroller's
/// compiler sees; `at` when there is none.
std::size_t behind_ignored(std::string_view source, std::size_t at, bool line_start) {
  if (source.substr(at, 2) == "//") return std::min(source.find('\n', at), source.size());
  if (source.substr(at, 2) == "/*") {
    const std::size_t end = source.find("*/", at + 2);
    return end == std::string_view::npos ? source.size() : end + 2;
  }
  if (!line_start || source[at] != '#') return at;
  return source.substr(at).starts_with("#ifdef __AVR__\n") ? branch_end(source, at)
                                                           : line_end(source, at);
}

std::size_t behind_number(std::string_view source, std::size_t at) {
  const bool hexadecimal = source.substr(at, 2) == "0x" || source.substr(at, 2) == "0X";
  for (; at < source.size(); ++at) {
    const char c = source[at];
    const bool exponent = !hexadecimal && (c == 'e' || c == 'E') && at + 1 < source.size() &&
                          (source[at + 1] == '-' || source[at + 1] == '+');
    if (exponent) ++at;
    const bool separator = c == '\'' && at + 1 < source.size() && is_word(source[at + 1]);
    if (!exponent && !separator && !is_word(c) && c != '.') break;
  }
  return at;
}

std::size_t behind_sign(std::string_view source, std::size_t at) {
  for (const std::string_view sign : kSigns) {
    if (source.substr(at, sign.size()) == sign) return at + sign.size();
  }
  return at + 1;
}

}  // namespace

std::vector<Token> tokens_of(std::string_view source) {
  std::vector<Token> tokens;
  bool line_start = true;
  for (std::size_t at = 0; at < source.size();) {
    const char c = source[at];
    if (is_space(c)) {
      line_start = line_start || c == '\n';
      ++at;
      continue;
    }
    if (const std::size_t behind = behind_ignored(source, at, line_start); behind != at) {
      at = behind;
      continue;
    }
    line_start = false;
    std::size_t end = at;
    TokenKind kind = TokenKind::kSign;
    if (is_digit(c) || (c == '.' && at + 1 < source.size() && is_digit(source[at + 1]))) {
      kind = TokenKind::kNumber;
      end = behind_number(source, at);
    } else if (is_word(c)) {
      kind = TokenKind::kWord;
      while (end < source.size() && is_word(source[end])) ++end;
      if (end < source.size() && source[end] == '"' && source[end - 1] == 'R') {
        kind = TokenKind::kText;
        end = behind_raw_text(source, end);
      }
    } else if (c == '"' || c == '\'') {
      kind = TokenKind::kText;
      end = behind_quote(source, at);
    } else {
      end = behind_sign(source, at);
    }
    const bool spaced =
        at > 0 && is_space(source[at - 1]) && end < source.size() && is_space(source[end]);
    tokens.push_back({kind, source.substr(at, end - at), at, end, spaced});
    at = end;
  }
  return tokens;
}

}  // namespace screed::mutants
