// Reading a JSON file strictly: every value is asked for by name and kind, and whatever does not
// fit is refused with one line that names the file, the path in it, and what is allowed. Knows
// nothing of which names mean what.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/core/json.h"

namespace screed {

/// Reads a file as JSON; comments // and /* */ are allowed. Throws InputError, "<file>: ...", for a
/// file that does not exist, cannot be read, or is no JSON.
Json read_json_file(const std::filesystem::path& file);
/// The same from a text; messages call it `name`.
Json read_json_text(const std::string& text, const std::string& name);

/// A value in a JSON document, with its place. Every function throws InputError, "<file>: <path>:
/// ..., allowed is ...", for a value of another kind or beyond its range. The document must outlive
/// it.
class JsonValue {
 public:
  JsonValue(const Json& value, std::string file);

  const std::string& path() const { return path_; }

  // Of an object.
  /// Refuses members of other names.
  void only(std::initializer_list<std::string_view> names) const;
  bool has(std::string_view name) const;
  JsonValue at(std::string_view name) const;

  // Of a list.
  /// Its values; refuses a list with fewer than `minimum` or more than `maximum` of them.
  std::vector<JsonValue> list(std::size_t minimum = 0, std::size_t maximum = SIZE_MAX) const;

  // Of a single value.
  std::string text() const;
  std::string one_of(std::initializer_list<std::string_view> allowed) const;
  bool flag() const;
  std::int64_t integer(std::int64_t minimum, std::int64_t maximum) const;
  std::uint64_t unsigned_integer() const;
  /// Finite.
  double number(double minimum, double maximum) const;

  /// Throws InputError at this place: what is wrong, "; allowed is ..." included.
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  JsonValue(const Json& value, std::string file, std::string path);
  const Json& object() const;

  const Json* value_;
  std::string file_;
  std::string path_;  ///< "networks[0].layers[2].bias"; empty: the document
};

}  // namespace screed
