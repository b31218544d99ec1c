// Figures in texts.
#include "host_sim/core/figures.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>

namespace screed {
namespace {

template <class Value>
std::string printed(const std::string& form, Value value) {
  std::string text(static_cast<std::size_t>(std::snprintf(nullptr, 0, form.c_str(), value)), ' ');
  std::snprintf(text.data(), text.size() + 1, form.c_str(), value);
  return text;
}

/// `next`: of the list, for names that are empty.
const Json& find(const Json& figures, const std::string& name, std::size_t& next) {
  if (name.empty()) return figures.is_array() ? figures.at(next++) : figures;
  const Json* at = &figures;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('.', begin), name.size());
    const std::string part = name.substr(begin, end - begin);
    at = at->is_array() ? &at->at(std::strtoul(part.c_str(), nullptr, 10)) : &at->at(part);
    begin = end + 1;
  }
  return *at;
}

/// What stands for the text between two braces.
std::string figure(const Json& figures, const std::string& field, std::size_t& next) {
  const std::size_t colon = std::min(field.find(':'), field.size());
  const std::size_t star = std::min(field.find('*'), colon);
  const Json& value = find(figures, field.substr(0, star), next);
  const bool is_text = colon == field.size() || field.back() == 's';
  std::string text = !is_text ? "" : value.is_string() ? value.text() : value.dump();
  if (colon == field.size()) return text;
  const std::string form = "%" + field.substr(colon + 1);
  if (is_text) return printed(form, text.c_str());
  const double factor = star == colon ? 1.0 : std::strtod(field.c_str() + star + 1, nullptr);
  return printed(form, factor * value.get<double>());
}

}  // namespace

std::string filled(std::string_view pattern, const Json& figures) {
  std::string text;
  std::size_t next = 0;
  for (;;) {
    const std::size_t begin = pattern.find('{');
    const std::size_t end = pattern.find('}', begin);
    if (end == std::string_view::npos) return text.append(pattern);
    text += pattern.substr(0, begin);
    text += figure(figures, std::string(pattern.substr(begin + 1, end - begin - 1)), next);
    pattern.remove_prefix(end + 1);
  }
}

std::string counted(std::uint64_t count, std::string_view one) {
  return std::to_string(count).append(" ").append(one).append(count == 1 ? "" : "s");
}

void print(std::string_view pattern, const Json& figures) {
  std::cout << filled(pattern, figures);
}

void print_json(const Json& json, int indent) {
  std::cout << json.dump(indent, Json::BadText::kReplace) << "\n";
}

}  // namespace screed
