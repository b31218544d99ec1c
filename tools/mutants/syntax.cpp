#include "tools/mutants/syntax.h"

#include <algorithm>

namespace screed::mutants {
namespace {

bool opens(std::string_view text) {
  return text == "(" || text == "[" || text == "{";
}
bool closes(std::string_view text) {
  return text == ")" || text == "]" || text == "}";
}

}  // namespace

bool is_one_of(std::string_view text, const std::vector<std::string_view>& list) {
  return std::find(list.begin(), list.end(), text) != list.end();
}

Syntax::Syntax(std::string_view source) : tokens_(tokens_of(source)) {
  pair_brackets();
  mark_statements();
}

void Syntax::pair_brackets() {
  partner_.assign(size(), kNone);
  around_.assign(size(), kNone);
  kind_.assign(size(), Bracket::kRound);
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < size(); ++i) {
    if (closes(text(i)) && !open.empty()) {
      partner_[i] = open.back();
      partner_[open.back()] = i;
      kind_[i] = kind_[open.back()];
      open.pop_back();
    }
    if (!open.empty()) around_[i] = open.back();
    if (!opens(text(i))) continue;
    kind_[i] = text(i) == "(" ? Bracket::kRound : text(i) == "[" ? Bracket::kSquare : brace_kind(i);
    open.push_back(i);
  }
}

// Brackets before `i` are paired already.
Bracket Syntax::brace_kind(std::size_t i) const {
  bool has_round = false;
  Bracket declared = Bracket::kList;
  for (std::size_t k = i; k-- > 0;) {
    if (closes(text(k)) && text(k) != "}" && partner_[k] != kNone) {
      has_round = has_round || text(k) == ")";
      k = partner_[k];
      continue;
    }
    if (text(k) == ";" || text(k) == "{" || text(k) == "}" || opens(text(k))) break;
    if (text(k) == "namespace" || text(k) == "extern") declared = Bracket::kNamespace;
    if (is_one_of(text(k), {"class", "struct", "union"})) declared = Bracket::kClass;
    if (text(k) == "enum") declared = Bracket::kEnum;
  }
  if (declared != Bracket::kList && !has_round) return declared;
  const std::string_view before = text(i - 1);
  const bool in_list = around_[i] != kNone && kind_[around_[i]] == Bracket::kList;
  if (is_one_of(before, {")", "else", "do", "try", "const", "noexcept", "override", "mutable"})) {
    return Bracket::kBlock;
  }
  if (is_one_of(before, {";", "{", "}", ":"})) return in_list ? Bracket::kList : Bracket::kBlock;
  // The result type of a lambda.
  std::size_t k = i - 1;
  while (k > 0 && (tokens_[k].kind == TokenKind::kWord ||
                   is_one_of(text(k), {"::", "<", ">", "&", "*", ","}))) {
    --k;
  }
  return text(k) == "->" && k > 0 && text(k - 1) == ")" ? Bracket::kBlock : Bracket::kList;
}

void Syntax::mark_statements() {
  starts_.assign(size(), false);
  for (std::size_t i = 1; i < size(); ++i) {
    const std::size_t before = i - 1;
    const std::string_view word = text(before);
    if (!within(i, Bracket::kBlock)) continue;
    if (word == ";" || word == "else" || word == "do" || word == "{") starts_[i] = true;
    if (word == "}" && kind_[before] == Bracket::kBlock) starts_[i] = true;
    if (word == ")" && partner_[before] != kNone && partner_[before] > 0) {
      const std::size_t header = partner_[before] - 1;
      starts_[i] = is_one_of(text(header), {"if", "for", "while", "switch"}) ||
                   (text(header) == "constexpr" && header > 0 && text(header - 1) == "if");
    }
    if (starts_[i] && is_one_of(text(i), {"case", "default"})) {
      const std::size_t colon = find(i, {":", ";"});
      if (colon + 1 < size()) starts_[colon + 1] = true;
    }
    // A case behind a case.
    if (word == ":" && starts_[i] && is_one_of(text(i), {"case", "default"})) starts_[i] = true;
  }
}

std::size_t Syntax::find(std::size_t i, const std::vector<std::string_view>& ends) const {
  while (i < size() && !closes(text(i)) && !is_one_of(text(i), ends)) {
    i = opens(text(i)) && partner_[i] != kNone ? partner_[i] + 1 : i + 1;
  }
  return i;
}

std::size_t Syntax::find_back(std::size_t i, const std::vector<std::string_view>& ends) const {
  while (i != kNone && !opens(text(i)) && !is_one_of(text(i), ends)) {
    i = closes(text(i)) && partner_[i] != kNone ? partner_[i] - 1 : i - 1;
  }
  return i;
}

std::size_t Syntax::behind_arguments(std::size_t i) const {
  if (text(i) != "<" || tokens_[i].begin != tokens_[i - 1].end) return i;
  int depth = 0;
  for (std::size_t k = i; k < size(); ++k) {
    if (is_one_of(text(k), {";", "{", "}", "&&", "||"})) return i;
    if (text(k) == "<") ++depth;
    if (text(k) == ">") --depth;
    if (text(k) == ">>") depth -= 2;
    if (depth <= 0) return k + 1;
  }
  return i;
}

std::size_t Syntax::behind_operand(std::size_t i) const {
  while (is_one_of(text(i), {"!", "-", "*", "&", "~"})) ++i;
  if (i >= size()) return kNone;
  if (tokens_[i].kind == TokenKind::kNumber) return i + 1;
  if (tokens_[i].kind == TokenKind::kWord) {
    ++i;
  } else if (text(i) == "(") {
    i = partner_[i] == kNone ? kNone : partner_[i] + 1;
  } else {
    return kNone;
  }
  while (i < size()) {
    if (const std::size_t behind = behind_arguments(i); behind != i) {
      i = behind;
    } else if (is_one_of(text(i), {"::", ".", "->"})) {
      i += 2;
    } else if ((text(i) == "(" || text(i) == "[" || (text(i) == "{" && !tokens_[i].spaced)) &&
               partner_[i] != kNone && tokens_[i].begin == tokens_[i - 1].end) {
      i = partner_[i] + 1;
    } else {
      break;
    }
  }
  return i;
}

std::size_t Syntax::operand_ending_at(std::size_t i) const {
  while (i > 0) {
    if ((text(i) == ")" || text(i) == "]") && partner_[i] != kNone) {
      i = partner_[i];
      const Token& before = tokens_[i - 1];
      const bool follows = before.kind == TokenKind::kWord || closes(before.text);
      if (!follows || before.end != tokens_[i].begin) break;
      --i;
    } else if (is_one_of(text(i - 1), {"::", ".", "->"})) {
      i -= 2;
    } else {
      break;
    }
  }
  if (i > 0 && text(i - 1) == "*" && !tokens_[i - 1].spaced) --i;
  return i;
}

bool Syntax::is_expression(std::size_t i) const {
  if (is_one_of(text(i), {"++", "--", "*", "("})) return true;
  if (is_one_of(text(i), {"throw", "break", "continue", "delete"})) return true;
  if (text(i) == "return") return text(i + 1) == ";";
  if (is_one_of(text(i), {"if",       "for",           "while",     "switch",  "do",
                          "else",     "try",           "case",      "default", "using",
                          "typedef",  "static_assert", "constexpr", "const",   "auto",
                          "static",   "struct",        "class",     "enum",    "goto",
                          "template", "unsigned",      "extern",    "catch",   "alignas"})) {
    return false;
  }
  if (tokens_[i].kind != TokenKind::kWord) return false;
  ++i;
  while (text(i) == "::") i += 2;
  const std::size_t behind = behind_arguments(i);
  if (behind != i && text(behind) != "(") return false;
  i = behind;
  return is_one_of(text(i), {"(", "=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>=",
                             ".", "->", "[", "++", "--"}) ||
         (text(i) == "<<" && tokens_[i].spaced);
}

}  // namespace screed::mutants
