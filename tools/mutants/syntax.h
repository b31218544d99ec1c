// As much of the syntax of a source as the operators need: brackets, blocks, statements, operands.
#pragma once

#include <string_view>
#include <vector>

#include "tools/mutants/tokens.h"

namespace screed::mutants {

inline constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// What a bracket holds; a block holds statements.
enum class Bracket { kRound, kSquare, kBlock, kClass, kEnum, kNamespace, kList };

class Syntax {
 public:
  explicit Syntax(std::string_view source);

  const std::vector<Token>& tokens() const { return tokens_; }
  std::size_t size() const { return tokens_.size(); }
  /// The token's text; "" beyond the ends.
  std::string_view text(std::size_t i) const {
    return i < tokens_.size() ? tokens_[i].text : std::string_view();
  }
  /// The other bracket of a pair.
  std::size_t partner(std::size_t i) const { return partner_[i]; }
  /// The open bracket around a token, or kNone.
  std::size_t around(std::size_t i) const { return around_[i]; }
  Bracket kind(std::size_t open) const { return kind_[open]; }
  bool within(std::size_t i, Bracket kind) const {
    return around_[i] != kNone && kind_[around_[i]] == kind;
  }
  bool starts_statement(std::size_t i) const { return starts_[i]; }
  /// The first token from `i` on, outside of brackets that open on the way, that is one of `ends`;
  /// or the bracket that closes around it.
  std::size_t find(std::size_t i, const std::vector<std::string_view>& ends) const;
  /// The same backwards.
  std::size_t find_back(std::size_t i, const std::vector<std::string_view>& ends) const;
  /// Behind the operand of a prefix operator that begins at `i`; kNone when it is not understood.
  std::size_t behind_operand(std::size_t i) const;
  /// First token of the operand whose last one is `i`.
  std::size_t operand_ending_at(std::size_t i) const;
  /// Whether the statement that begins at `i` is an expression, and so can be left out.
  bool is_expression(std::size_t i) const;

 private:
  void pair_brackets();
  Bracket brace_kind(std::size_t i) const;
  void mark_statements();
  /// Behind the template arguments at `i`, or `i`.
  std::size_t behind_arguments(std::size_t i) const;

  std::vector<Token> tokens_;
  std::vector<std::size_t> partner_;
  std::vector<std::size_t> around_;
  std::vector<Bracket> kind_;
  std::vector<bool> starts_;
};

bool is_one_of(std::string_view text, const std::vector<std::string_view>& list);

}  // namespace screed::mutants
