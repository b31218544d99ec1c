// The mutation operators.
#include "tools/mutants/operators.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <tuple>

#include "tools/mutants/syntax.h"

namespace screed::mutants {
namespace {

struct Binary {
  std::string_view sign;
  const char* type;  ///< in mutant_switch.h
  const char* name;
  std::array<const char*, 2> others;
};
constexpr std::array<Binary, 16> kBinary{{
    {"+", "Plus", "arithmetic", {"-", nullptr}},
    {"-", "Minus", "arithmetic", {"+", nullptr}},
    {"*", "Times", "arithmetic", {"/", nullptr}},
    {"/", "Over", "arithmetic", {"*", nullptr}},
    {"%", "Modulo", "arithmetic", {"*", nullptr}},
    {"&", "BitAnd", "bits", {"|", nullptr}},
    {"|", "BitOr", "bits", {"&", nullptr}},
    {"^", "BitXor", "bits", {"|", nullptr}},
    {"<<", "ShiftLeft", "bits", {">>", nullptr}},
    {">>", "ShiftRight", "bits", {"<<", nullptr}},
    {"<", "Less", "comparison", {"<=", ">="}},
    {"<=", "LessEqual", "comparison", {"<", ">"}},
    {">", "Greater", "comparison", {">=", "<="}},
    {">=", "GreaterEqual", "comparison", {">", "<"}},
    {"==", "Equal", "comparison", {"!=", nullptr}},
    {"!=", "NotEqual", "comparison", {"==", nullptr}},
}};

struct Assignment {
  std::string_view sign;
  const char* function;
  const char* other;
};
constexpr std::array<Assignment, 6> kAssignments{{{"+=", "add", "-="},
                                                  {"-=", "subtract", "+="},
                                                  {"*=", "multiply", "/="},
                                                  {"/=", "divide", "*="},
                                                  {"|=", "set_bits", "&="},
                                                  {"&=", "keep_bits", "|="}}};

const std::vector<std::string_view> kBeforeExpression{
    ";", ",", "?", ":", "=", "return", "+=", "-=", "*=", "/=", "|=", "&=", "case", "{", "}"};

class Finder {
 public:
  explicit Finder(std::string_view source) : source_(source), syntax_(source) {}

  Mutations find() {
    find_constants();
    for (std::size_t i = 0; i < syntax_.size(); ++i) {
      if (syntax_.text(i) == "static_assert" && syntax_.text(i + 1) == "(") {
        i = syntax_.partner(i + 1);
        continue;
      }
      if (syntax_.starts_statement(i)) statement(i);
      if (syntax_.text(i) == "if" || syntax_.text(i) == "while") condition(i);
      if (token(i).kind == TokenKind::kNumber) number(i);
      if (token(i).kind == TokenKind::kWord) word(i);
      if (token(i).kind == TokenKind::kSign) sign(i);
    }
    std::stable_sort(mutations_.sites.begin(), mutations_.sites.end(),
                     [](const Site& a, const Site& b) {
                       return a.mutants[0].edit.begin < b.mutants[0].edit.begin;
                     });
    std::size_t number = 1;
    for (Site& site : mutations_.sites) {
      site.first_number = number;
      number += site.mutants.size();
    }
    return std::move(mutations_);
  }

 private:
  const Token& token(std::size_t i) const { return syntax_.tokens()[i]; }
  std::string_view text(std::size_t i) const { return syntax_.text(i); }
  std::string between(std::size_t begin, std::size_t end) const {
    return std::string(source_.substr(begin, end - begin));
  }

  void add(std::size_t i, Site site) {
    std::size_t outer = syntax_.around(i);
    for (; outer != kNone; outer = syntax_.around(outer)) {
      if (syntax_.kind(outer) == Bracket::kBlock) site.function = token(outer).begin;
    }
    for (const Constant& constant : mutations_.constants) {
      if (token(i).begin > constant.begin && token(i).begin < constant.end)
        site.constant = constant.name;
    }
    mutations_.sites.push_back(std::move(site));
  }

  void find_constants() {
    for (std::size_t i = 0; i < syntax_.size(); ++i) {
      if (text(i) != "constexpr" || (i > 0 && text(i - 1) == "if")) continue;
      // The name stands before the first of these.
      const std::size_t behind = syntax_.find(i + 1, {"=", "{", "[", "(", ";"});
      if (behind >= syntax_.size()) continue;
      Constant constant{std::string(text(behind - 1)), token(i).begin, 0, text(behind) == "("};
      std::size_t end = syntax_.find(behind, {";"});
      if (constant.is_function) {
        const std::size_t body = syntax_.find(behind, {"{", ";"});
        end = text(body) == "{" ? syntax_.partner(body) : body;
      }
      if (end == kNone || end >= syntax_.size()) continue;
      constant.end = token(end).end;
      mutations_.constants.push_back(std::move(constant));
    }
  }

  void statement(std::size_t i) {
    if (!syntax_.is_expression(i)) return;
    const std::size_t end = syntax_.find(i, {";"});
    if (text(end) != ";") return;
    const std::size_t behind = token(end).end;
    Site site;
    site.mutants.push_back({{token(i).begin, behind, ";"}, "statement"});
    site.wraps.push_back({token(i).begin, behind, "{ if (!::mutants::on(@0)) { ", " } }"});
    add(i, std::move(site));
  }

  /// Whether a comparison or a ! decides it alone: the opposite is a mutant of that already.
  bool decided_by_one_sign(std::size_t begin, std::size_t end) const {
    if (text(begin) == "!" && syntax_.behind_operand(begin + 1) == end) return true;
    int comparisons = 0;
    for (std::size_t i = begin; i < end; ++i) {
      if (text(i) == "(" || text(i) == "[" || text(i) == "{") {
        i = syntax_.partner(i);
        continue;
      }
      if (is_one_of(text(i), {"&&", "||"})) return false;
      if (token(i).spaced && is_one_of(text(i), {"<", "<=", ">", ">=", "==", "!="})) ++comparisons;
    }
    return comparisons == 1;
  }

  void condition(std::size_t i) {
    const std::size_t open = i + 1;
    if (text(open) != "(" || syntax_.partner(open) == kNone) return;
    const std::size_t close = syntax_.partner(open);
    if (syntax_.find(open + 1, {"=", ";"}) != close) return;
    const std::size_t begin = token(open + 1).begin;
    const std::size_t end = token(close).begin;
    Site site;
    std::string numbers;
    if (decided_by_one_sign(open + 1, close)) {
      numbers = "-1, ";
    } else {
      site.mutants.push_back({{begin, end, "!(" + between(begin, end) + ")"}, "condition"});
      numbers = "@0, ";
    }
    if (text(i) == "if") {
      numbers += "@" + std::to_string(site.mutants.size()) + ", ";
      site.mutants.push_back({{begin, end, "true"}, "guard"});
    } else {
      numbers += "-1, ";
    }
    if (site.mutants.empty()) return;
    site.wraps.push_back(
        {begin, end, "::mutants::condition(" + numbers + "static_cast<bool>(", "))"});
    add(i, std::move(site));
  }

  void number(std::size_t i) {
    const bool template_argument =
        (i > 0 && text(i - 1) == "<" && !token(i - 1).spaced) ||
        ((text(i + 1) == ">" || text(i + 1) == ">>") && token(i + 1).begin == token(i).end);
    const bool pure_virtual = i > 1 && text(i - 1) == "=" && text(i + 1) == ";" &&
                              is_one_of(text(i - 2), {")", "const", "noexcept", "override"});
    if (template_argument || pure_virtual || syntax_.within(i, Bracket::kEnum)) return;
    if (i > 0 && text(i - 1) == "case") return;
    // The size of an array where it is declared: what goes beyond it is no behaviour.
    if (i > 2 && text(i - 1) == "[" && text(i + 1) == "]" && !is_one_of(text(i - 3), {"return"}) &&
        token(i - 2).kind == TokenKind::kWord && token(i - 3).kind == TokenKind::kWord) {
      return;
    }
    replace(i, i, other_numbers(text(i)), "constant", "");
  }

  /// Tokens `first` to `last` become one of `others`; all as one expression.
  void replace(std::size_t first, std::size_t last, const std::vector<std::string>& others,
               const std::string& name, const std::string& switched) {
    if (others.empty()) return;
    const std::size_t begin = token(first).begin;
    const std::size_t end = token(last).end;
    Site site;
    std::string text = "(";
    for (std::size_t k = 0; k < others.size(); ++k) {
      const std::string suffix = others.size() > 1 ? "." + std::to_string(k + 1) : "";
      site.mutants.push_back({{begin, end, others[k]}, name + suffix});
      text += "::mutants::on(@" + std::to_string(k) + ") ? " + others[k] + " : ";
    }
    text += between(begin, end) + ")";
    site.replacements.push_back({begin, end, switched.empty() ? text : switched});
    add(first, std::move(site));
  }

  void word(std::size_t i) {
    if (text(i) == "true") replace(i, i, {"false"}, "boolean", "");
    if (text(i) == "false") replace(i, i, {"true"}, "boolean", "");
    const bool least = text(i) == "min";
    if ((!least && text(i) != "max") || i < 2 || text(i - 1) != "::" || text(i - 2) != "std")
      return;
    if (text(i + 1) != "(" && text(i + 1) != "<") return;
    const std::string type = least ? "::mutants::Min{@0}" : "::mutants::Max{@0}";
    replace(i - 2, i, {least ? "std::max" : "std::min"}, "min-max",
            type + (text(i + 1) == "<" ? ".template of" : ".of"));
  }

  void sign(std::size_t i) {
    if (token(i).spaced) {
      for (const Binary& binary : kBinary) {
        if (text(i) == binary.sign) two_operands(i, binary);
      }
    }
    for (const Assignment& assignment : kAssignments) {
      if (text(i) == assignment.sign) change(i, assignment);
    }
    if (text(i) == "&&" || text(i) == "||") logical(i);
    if (text(i) == "?") ternary(i);
    if (text(i) == "++" || text(i) == "--") step(i);
    if (text(i) == "!" || (text(i) == "-" && !token(i).spaced)) prefix(i);
  }

  void two_operands(std::size_t i, const Binary& binary) {
    Site site;
    for (const char* other : binary.others) {
      if (other == nullptr) break;
      const bool several = binary.others[1] != nullptr;
      const char* suffix = !several ? "" : site.mutants.empty() ? ".1" : ".2";
      site.mutants.push_back(
          {{token(i).begin, token(i).end, other}, std::string(binary.name) + suffix});
    }
    const std::string sign(binary.sign);
    site.replacements.push_back(
        {token(i).begin, token(i).end, sign + " ::mutants::" + binary.type + "{@0} " + sign});
    add(i, std::move(site));
  }

  void change(std::size_t i, const Assignment& assignment) {
    const std::size_t left = syntax_.operand_ending_at(i - 1);
    const std::size_t right = syntax_.find(i + 1, {";", ","});
    Site site;
    site.mutants.push_back({{token(i).begin, token(i).end, assignment.other}, "assignment"});
    site.wraps.push_back({token(left).begin, token(right - 1).end,
                          std::string("::mutants::") + assignment.function + "(@0, ", ")"});
    site.replacements.push_back({token(i).begin, token(i).end, ","});
    add(i, std::move(site));
  }

  // a && b is !(!a || !b): one switch turns a, b and the whole.
  void logical(std::size_t i) {
    if (!token(i).spaced) return;
    const bool conjunction = text(i) == "&&";
    std::vector<std::string_view> before = kBeforeExpression;
    if (conjunction) before.emplace_back("||");
    std::vector<std::string_view> behind{";", ",", "?", ":", "||"};
    if (conjunction) behind.emplace_back("&&");
    const std::size_t left = syntax_.find_back(i - 1, before) + 1;
    const std::size_t right = syntax_.find(i + 1, behind) - 1;
    const std::string flip = "::mutants::flip(@0, static_cast<bool>(";
    Site site;
    site.mutants.push_back({{token(i).begin, token(i).end, conjunction ? "||" : "&&"}, "logical"});
    site.wraps.push_back({token(left).begin, token(right).end, flip, "))"});
    site.wraps.push_back({token(left).begin, token(i - 1).end, flip, "))"});
    site.wraps.push_back({token(i + 1).begin, token(right).end, flip, "))"});
    add(i, std::move(site));
  }

  void ternary(std::size_t i) {
    const std::size_t first = syntax_.find_back(i - 1, kBeforeExpression) + 1;
    if (decided_by_one_sign(first, i)) return;
    const std::size_t begin = token(first).begin;
    const std::size_t end = token(i - 1).end;
    Site site;
    site.mutants.push_back({{begin, end, "!(" + between(begin, end) + ")"}, "condition"});
    site.wraps.push_back({begin, end, "::mutants::flip(@0, static_cast<bool>(", "))"});
    add(i, std::move(site));
  }

  void step(std::size_t i) {
    const std::string up = text(i) == "++" ? "increment" : "decrement";
    Site site;
    site.mutants.push_back({{token(i).begin, token(i).end, text(i) == "++" ? "--" : "++"}, "step"});
    const std::size_t behind = syntax_.behind_operand(i + 1);
    if (token(i + 1).begin == token(i).end && behind != kNone &&
        (token(i + 1).kind == TokenKind::kWord || text(i + 1) == "*")) {
      site.wraps.push_back({token(i).begin, token(behind - 1).end, "", ")"});
      site.replacements.push_back({token(i).begin, token(i).end, "::mutants::" + up + "(@0, "});
    } else if (i > 0 && token(i - 1).end == token(i).begin) {
      const std::size_t left = syntax_.operand_ending_at(i - 1);
      site.wraps.push_back(
          {token(left).begin, token(i).end, "::mutants::post_" + up + "(@0, ", ")"});
      site.replacements.push_back({token(i).begin, token(i).end, ""});
    } else {
      return;
    }
    add(i, std::move(site));
  }

  void prefix(std::size_t i) {
    if (text(i) == "-" && i > 0 &&
        (is_one_of(text(i - 1), {")", "]"}) || token(i - 1).kind == TokenKind::kNumber ||
         (token(i - 1).kind == TokenKind::kWord && text(i - 1) != "return"))) {
      return;
    }
    const std::size_t behind = syntax_.behind_operand(i + 1);
    if (behind == kNone) return;
    const bool minus = text(i) == "-";
    Site site;
    site.mutants.push_back({{token(i).begin, token(i).end, ""}, minus ? "sign" : "negation"});
    site.wraps.push_back(
        {token(i).begin, token(behind - 1).end, minus ? "" : "::mutants::flip(@0, ", ")"});
    if (minus) {
      site.replacements.push_back({token(i).begin, token(i).end, "::mutants::negative(@0, "});
    }
    add(i, std::move(site));
  }

  std::string_view source_;
  Syntax syntax_;
  Mutations mutations_;
};

std::string numbered(std::string text, std::size_t first) {
  for (std::size_t at = text.find('@'); at != std::string::npos; at = text.find('@')) {
    const auto offset = static_cast<std::size_t>(text[at + 1] - '0');
    text.replace(at, 2, std::to_string(first + offset));
  }
  return text;
}

std::vector<std::string> other_integers(std::uint64_t value, bool hexadecimal,
                                        const std::string& suffix) {
  std::vector<std::uint64_t> values;
  if (value == 0) {
    values = {1};
  } else if (value <= 16) {
    values = {value - 1, value + 1};
  } else {
    values = {value - value / 8, value + value / 8};
  }
  std::vector<std::string> texts;
  for (const std::uint64_t other : values) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), hexadecimal ? "0x%llX" : "%llu",
                  static_cast<unsigned long long>(other));
    texts.push_back(text.data() + suffix);
  }
  return texts;
}

std::string real(double value, const std::string& suffix) {
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size() - 1, value).ptr;
  std::string written(text.data(), end);
  if (written.find_first_of(".e") == std::string::npos) written += ".0";
  return written + suffix;
}

}  // namespace

std::vector<std::string> other_numbers(std::string_view number) {
  std::string plain(number);
  std::erase(plain, '\'');
  const bool hexadecimal = plain.starts_with("0x") || plain.starts_with("0X");
  if (!hexadecimal && plain.find_first_of(".eE") != std::string::npos) {
    char* end = nullptr;
    const double value = std::strtod(plain.c_str(), &end);
    const std::string suffix(end);
    if (value == 0.0) return {real(1.0, suffix)};
    return {real(value / 2.0, suffix), real(value * 2.0, suffix)};
  }
  char* end = nullptr;
  if (plain.starts_with("0b")) return {};
  const std::uint64_t value = std::strtoull(plain.c_str(), &end, 0);
  return other_integers(value, hexadecimal, end);
}

Mutations find_mutations(std::string_view source) {
  return Finder(source).find();
}

std::string with_edit(std::string_view source, const Edit& edit) {
  return std::string(source.substr(0, edit.begin)) + edit.text +
         std::string(source.substr(edit.end));
}

std::string with_switches(std::string_view source, const Mutations& mutations,
                          const std::set<std::size_t>& alone, const std::set<std::string>& kept,
                          std::size_t first) {
  // At one place first what closes, the inner first; then what opens, the outer first; then what
  // stands for the token.
  struct Event {
    std::size_t at;
    int rank;
    std::size_t other_end;
    long order;
    std::size_t skip;
    std::string text;
  };
  std::vector<Event> events;
  std::set<std::string> switched;
  long order = 0;
  for (std::size_t i = 0; i < mutations.sites.size(); ++i) {
    const Site& site = mutations.sites[i];
    if (alone.contains(i) || kept.contains(site.constant)) continue;
    switched.insert(site.constant);
    const std::size_t number = first + site.first_number;
    for (const Wrap& wrap : site.wraps) {
      ++order;
      events.push_back(
          {wrap.begin, 1, SIZE_MAX - wrap.end, order, 0, numbered(wrap.before, number)});
      events.push_back(
          {wrap.end, 0, SIZE_MAX - wrap.begin, -order, 0, numbered(wrap.behind, number)});
    }
    for (const Edit& edit : site.replacements) {
      events.push_back({edit.begin, 2, 0, 0, edit.end - edit.begin, numbered(edit.text, number)});
    }
  }
  for (const Constant& constant : mutations.constants) {
    if (!switched.contains(constant.name) || kept.contains(constant.name)) continue;
    events.push_back({constant.begin, 2, 0, 0, std::string_view("constexpr").size(),
                      constant.is_function ? "inline" : "const"});
  }
  std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
    return std::tie(a.at, a.rank, a.other_end, a.order) <
           std::tie(b.at, b.rank, b.other_end, b.order);
  });
  std::string result;
  std::size_t at = 0;
  for (const Event& event : events) {
    result += source.substr(at, event.at - at);
    result += event.text;
    at = event.at + event.skip;
  }
  return result + std::string(source.substr(at));
}

}  // namespace screed::mutants
