// C++ text as tokens: comments, preprocessor lines and spaces left out.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace screed::mutants {

enum class TokenKind { kWord, kNumber, kText, kSign };

struct Token {
  TokenKind kind;
  std::string_view text;  ///< of the source, which outlives it
  std::size_t begin;      ///< offset of its first byte
  std::size_t end;        ///< behind its last byte
  bool spaced;  ///< spaces on both sides, as clang-format sets round an operator of two operands
};

std::vector<Token> tokens_of(std::string_view source);

}  // namespace screed::mutants
