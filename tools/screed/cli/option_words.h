// An option of a command line in words that people read: made from what the parser knows, for help,
// completion and manual. Header only: the smaller programs link without the library.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

namespace screed {

struct OptionWords {
  std::vector<std::string> names;  ///< "-h", "--help"; of an argument that has a place: "FILE"
  std::string value;               ///< "NUMBER", "FILE"; empty: takes none
  std::vector<std::string> choices;
  std::string range;  ///< "0.01 to 1000"
  std::string help;
  std::string group;     ///< the heading that it stands below: "Options"
  std::string fallback;  ///< the default; empty: none
  std::vector<std::string> needs;
  std::vector<std::string> excludes;
  bool is_positional = false;
  bool required = false;
  bool repeated = false;  ///< takes several values
};

namespace option_words {

/// What stands between the braces of "TEXT:{a,b}"; empty: nothing of that form.
inline std::vector<std::string> choices_in(const std::string& text) {
  const std::size_t begin = text.find('{');
  const std::size_t end = text.rfind('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  return CLI::detail::split(text.substr(begin + 1, end - begin - 1), ',');
}

/// The range of one of the parser's own checks: "FLOAT in [0.1 - 600]" is "0.1 to 600".
inline std::string range_in(const std::string& text) {
  if (text == "POSITIVE") return "more than 0";
  if (text == "NONNEGATIVE") return "0 or more";
  const std::size_t begin = text.find("in [");
  const std::size_t middle = text.find(" - ");
  if (begin == std::string::npos || middle == std::string::npos) return text;
  const std::size_t first = begin + 4;
  const std::string high = text.substr(middle + 3);
  return text.substr(first, middle - first) + " to " + high.substr(0, high.find(']'));
}

/// The word for a kind of value, in place of the parser's.
inline std::string value_word(const std::string& type) {
  if (type == "INT" || type == "UINT") return "INTEGER";
  if (type == "FLOAT") return "NUMBER";
  if (type == "DIR") return "FOLDER";
  return type;
}

/// What the parser calls the type, "TEXT:{a,b}" or "NUMBER:0 to 1" or "TEXT:FILE", taken apart.
inline void take_type(const std::string& type, OptionWords& words) {
  const std::size_t colon = type.find(':');
  words.value = value_word(type.substr(0, colon));
  if (colon == std::string::npos) return;
  const std::string rest = type.substr(colon + 1);
  words.choices = choices_in(rest);
  if (!words.choices.empty()) return;
  if (rest == "FILE" || rest == "DIR") {
    words.value = value_word(rest);
  } else {
    words.range = range_in(rest);
  }
}

/// Takes a default in words off the end of a help text: "Output folder (default: RUN/export)".
inline std::string take_default(std::string& help) {
  constexpr const char* kBegin = " (default: ";
  const std::size_t begin = help.rfind(kBegin);
  if (begin == std::string::npos || help.find(')', begin) + 1 != help.size()) return "";
  const std::size_t text = begin + std::string(kBegin).size();
  std::string fallback = help.substr(text, help.size() - 1 - text);
  help.resize(begin);
  return fallback;
}

/// Whether the help text says all of these words itself.
inline bool says_all(const std::string& help, const std::vector<std::string>& words) {
  return std::all_of(words.begin(), words.end(),
                     [&](const std::string& word) { return help.find(word) != std::string::npos; });
}

/// "[a,b]" of a list is "a,b".
inline std::string default_word(const std::string& text) {
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') return text;
  return text.substr(1, text.size() - 2);
}

/// An option whose value is a text of a kind that has no word is named like it: "--out OUT".
inline std::string word_of_name(const CLI::Option& option) {
  std::string word = option.get_lnames().empty() ? "TEXT" : option.get_lnames().front();
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return word;
}

}  // namespace option_words

inline OptionWords words_of(const CLI::Option& option) {
  OptionWords words;
  words.help = option.get_description();
  words.group = option.get_group();
  words.required = option.get_required();
  words.is_positional = option.get_positional();
  if (words.is_positional) {
    words.names = {option.get_name(true, false)};
  } else {
    for (const std::string& name : option.get_snames()) words.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) words.names.push_back("--" + name);
  }
  for (const CLI::Option* other : option.get_needs()) words.needs.push_back(other->get_name());
  for (const CLI::Option* other : option.get_excludes())
    words.excludes.push_back(other->get_name());
  // The parser keeps them ordered by where they lie in memory.
  std::sort(words.needs.begin(), words.needs.end());
  std::sort(words.excludes.begin(), words.excludes.end());
  words.fallback = option_words::take_default(words.help);
  if (option.get_items_expected_max() == 0) return words;
  option_words::take_type(option.get_type_name(), words);
  if (words.value == "TEXT" && !words.is_positional)
    words.value = option_words::word_of_name(option);
  if (words.fallback.empty() && !words.required)
    words.fallback = option_words::default_word(option.get_default_str());
  words.repeated = option.get_items_expected_max() >= CLI::detail::expected_max_vector_size;
  return words;
}

/// The range, the choices, the default, and what goes together, as a sentence that follows the help
/// text: "(0 to 1; default: 0.5)". Empty: nothing to say.
inline std::string details(const OptionWords& words) {
  const auto joined = [](const std::vector<std::string>& names) {
    return CLI::detail::join(names, ", ");
  };
  constexpr std::size_t kMaxChoices = 12;
  const bool lists_choices =
      words.choices.size() <= kMaxChoices && !option_words::says_all(words.help, words.choices);
  const bool says_repeated = words.help.find("may be repeated") != std::string::npos;
  std::vector<std::string> parts;
  if (!words.range.empty()) parts.push_back(words.range);
  if (lists_choices) parts.push_back(joined(words.choices));
  if (words.required && !words.is_positional) parts.emplace_back("required");
  if (words.repeated && !words.is_positional && !says_repeated)
    parts.emplace_back("may be repeated");
  if (!words.needs.empty()) parts.push_back("needs " + joined(words.needs));
  if (!words.excludes.empty()) parts.push_back("not with " + joined(words.excludes));
  if (!words.fallback.empty()) parts.push_back("default: " + words.fallback);
  return parts.empty() ? "" : "(" + CLI::detail::join(parts, "; ") + ")";
}

}  // namespace screed
