// The path in the document is built while walking down to it.
#include "host_sim/core/json_reader.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

std::string in_words(const std::initializer_list<std::string_view>& words) {
  std::string text;
  for (const std::string_view word : words) {
    if (!text.empty()) text += ", ";
    text += word;
  }
  return text;
}

std::string in_digits(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// The value as it stands in the file, cut where it is long.
std::string shown(const Json& value) {
  return value.dump(-1, Json::BadText::kReplace).substr(0, 40);
}

}  // namespace

Json read_json_text(const std::string& text, const std::string& name) {
  try {
    return Json::parse(text, true);
  } catch (const JsonSyntaxError& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    throw InputError(name + ":" + std::to_string(1 + std::count(text.begin(), end, '\n')) + ": " +
                     error.what());
  }
}

Json read_json_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream || std::filesystem::is_directory(file)) {
    throw InputError(file.string() + ": cannot be read");
  }
  return read_json_text(text.str(), file.string());
}

JsonValue::JsonValue(const Json& value, std::string file)
    : value_(&value), file_(std::move(file)) {}

JsonValue::JsonValue(const Json& value, std::string file, std::string path)
    : value_(&value), file_(std::move(file)), path_(std::move(path)) {}

void JsonValue::refuse(const std::string& what) const {
  throw InputError(file_ + ": " + (path_.empty() ? "" : path_ + ": ") + what);
}

const Json& JsonValue::object() const {
  if (!value_->is_object()) refuse(shown(*value_) + "; allowed is an object");
  return *value_;
}

void JsonValue::only(std::initializer_list<std::string_view> allowed) const {
  for (const auto& [name, value] : object().items()) {
    if (std::find(allowed.begin(), allowed.end(), name) == allowed.end()) {
      refuse("'" + name + "' is not known; allowed is " + in_words(allowed));
    }
  }
}

bool JsonValue::has(std::string_view name) const {
  return object().contains(name);
}

JsonValue JsonValue::at(std::string_view name) const {
  const Json* const found = object().find(name);
  if (found == nullptr) refuse("'" + std::string(name) + "' is missing");
  return {*found, file_, path_.empty() ? std::string(name) : path_ + "." + std::string(name)};
}

std::vector<JsonValue> JsonValue::list(std::size_t minimum, std::size_t maximum) const {
  if (!value_->is_array()) refuse(shown(*value_) + "; allowed is a list");
  if (value_->size() < minimum || value_->size() > maximum) {
    const std::string range = minimum == maximum ? std::to_string(minimum)
                              : maximum == SIZE_MAX
                                  ? std::to_string(minimum) + " or more"
                                  : std::to_string(minimum) + " to " + std::to_string(maximum);
    refuse(std::to_string(value_->size()) + " values; allowed is " + range);
  }
  std::vector<JsonValue> values;
  values.reserve(value_->size());
  for (const Json& value : *value_) {
    values.push_back({value, file_, path_ + "[" + std::to_string(values.size()) + "]"});
  }
  return values;
}

std::string JsonValue::text() const {
  if (!value_->is_string()) refuse(shown(*value_) + "; allowed is a text");
  return value_->text();
}

std::string JsonValue::one_of(std::initializer_list<std::string_view> allowed) const {
  std::string value = text();
  if (std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
    refuse("'" + value + "'; allowed is " + in_words(allowed));
  }
  return value;
}

bool JsonValue::flag() const {
  if (!value_->is_boolean()) refuse(shown(*value_) + "; allowed is true or false");
  return value_->get<bool>();
}

std::int64_t JsonValue::integer(std::int64_t minimum, std::int64_t maximum) const {
  const bool fits = value_->is_number_unsigned()
                        ? value_->get<std::uint64_t>() <= static_cast<std::uint64_t>(INT64_MAX)
                        : value_->is_number_integer();
  if (!fits || value_->get<std::int64_t>() < minimum || value_->get<std::int64_t>() > maximum) {
    refuse(shown(*value_) + "; allowed is an integer " + std::to_string(minimum) + " to " +
           std::to_string(maximum));
  }
  return value_->get<std::int64_t>();
}

std::uint64_t JsonValue::unsigned_integer() const {
  if (!value_->is_number_unsigned()) refuse(shown(*value_) + "; allowed is an integer from 0");
  return value_->get<std::uint64_t>();
}

double JsonValue::number(double minimum, double maximum) const {
  const double value = value_->is_number() ? value_->get<double>() : std::nan("");
  if (!(value >= minimum && value <= maximum)) {
    refuse(shown(*value_) + "; allowed is a number " + in_digits(minimum) + " to " +
           in_digits(maximum));
  }
  return value;
}

}  // namespace screed
