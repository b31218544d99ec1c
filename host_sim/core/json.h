// A JSON value: null, a truth value, a number, a text, a list or an object, whose members keep the
// order in which they came.
//
// The JSON library stands behind json_text.cpp alone: parsing its header costs a compiler more than
// most of our sources do.
#pragma once

#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace screed {

/// A text that is no JSON, a missing member, a value of another kind.
struct JsonError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A text that is no JSON.
struct JsonSyntaxError : JsonError {
  JsonSyntaxError(const std::string& what, std::size_t at) : JsonError(what), byte(at) {}
  std::size_t byte;  ///< how many bytes were read until it showed
};

class Json {
 public:
  class Item;
  struct Member;
  using Array = std::vector<Json>;
  using Object = std::vector<Member>;

  /// How a text that is not UTF-8 is written: refused by a JsonError, or with U+FFFD in place of
  /// what is wrong.
  enum class BadText : std::uint8_t { kRefuse, kReplace };

  Json() = default;  ///< null
  Json(std::nullptr_t) {}
  Json(bool value) : kind_(Kind::kBoolean) { content_.truth = value; }
  Json(int value) : Json(static_cast<long long>(value)) {}
  Json(long value) : Json(static_cast<long long>(value)) {}
  Json(long long value) : kind_(Kind::kInteger) { content_.integer = value; }
  Json(unsigned value) : Json(static_cast<unsigned long long>(value)) {}
  Json(unsigned long value) : Json(static_cast<unsigned long long>(value)) {}
  Json(unsigned long long value) : kind_(Kind::kUnsigned) { content_.natural = value; }
  Json(float value) : Json(static_cast<double>(value)) {}
  Json(double value) : kind_(Kind::kReal) { content_.real = value; }
  Json(std::string value);
  Json(std::string_view value);
  Json(const char* value);
  Json(const void* value) = delete;  ///< else a pointer would be a truth value
  Json(Array values);
  template <class T>
  Json(const std::vector<T>& values);
  /// An object where every item is a list of two whose first is a text: {{"x", 1}, {"y", 2}}. Else
  /// a list.
  Json(std::initializer_list<Item> items);

  Json(const Json& other);
  Json(Json&& other) noexcept
      : kind_(std::exchange(other.kind_, Kind::kNull)), content_(other.content_) {}
  Json& operator=(Json other) noexcept {
    std::swap(kind_, other.kind_);
    std::swap(content_, other.content_);
    return *this;
  }
  ~Json() {
    if (kind_ >= Kind::kText) release();
  }

  static Json array() { return Json(Array{}); }
  static Json array(std::initializer_list<Item> items);
  static Json object();
  static Json object(std::initializer_list<Item> members);

  /// Throws JsonSyntaxError. Of members of the same name the last counts. `comments`: // and /* */
  /// are passed over.
  static Json parse(std::string_view text, bool comments = false);
  /// Null for what is no JSON.
  static Json parse_or_null(std::string_view text);
  static Json parse_or_null(std::istream& stream);
  /// In one line, or with so many blanks before each level. A number reads back to the same bits;
  /// what is none becomes null.
  std::string dump(int indent = -1, BadText bad_text = BadText::kRefuse) const;

  bool is_null() const { return kind_ == Kind::kNull; }
  bool is_boolean() const { return kind_ == Kind::kBoolean; }
  bool is_number() const { return is_number_integer() || kind_ == Kind::kReal; }
  bool is_number_integer() const { return kind_ == Kind::kInteger || is_number_unsigned(); }
  /// An integer that was given as unsigned, or read and not negative.
  bool is_number_unsigned() const { return kind_ == Kind::kUnsigned; }
  bool is_string() const { return kind_ == Kind::kText; }
  bool is_array() const { return kind_ == Kind::kArray; }
  bool is_object() const { return kind_ == Kind::kObject; }
  bool is_structured() const { return is_array() || is_object(); }

  /// As a bool, a number, an enumeration's number, a std::string, a Json, or a std::vector of one
  /// of these. Throws JsonError for another kind; numbers are converted as static_cast does.
  template <class T>
  T get() const;
  const std::string& text() const;

  // Of an object. Null becomes one where a member is set.
  bool contains(std::string_view name) const { return find(name) != nullptr; }
  /// nullptr where there is none, and of what is no object.
  const Json* find(std::string_view name) const;
  const Json& at(std::string_view name) const;
  const Json& operator[](std::string_view name) const { return at(name); }
  /// A new member is null, and stands behind the others.
  Json& operator[](std::string_view name);
  /// The member, or the fallback where there is none.
  template <class T>
  T value(std::string_view name, T fallback) const;
  std::string value(std::string_view name, const char* fallback) const;
  const Object& items() const;
  /// Sets all members of another object.
  void update(Json other);
  void erase(std::string_view name);
  /// Orders members by their names, those of inner objects too.
  void sort_members();

  // Of a list. Null is an empty one.
  const Json& at(std::size_t index) const;
  const Json& operator[](std::size_t index) const { return at(index); }
  Json& operator[](std::size_t index);
  Json& back();
  void push_back(Json value);
  const Json* begin() const;
  const Json* end() const;

  /// Of values or members; 0 of null, 1 of what is single.
  std::size_t size() const;
  bool empty() const { return size() == 0; }

  /// Numbers are equal across their kinds; members stand in the same order.
  friend bool operator==(const Json& a, const Json& b);
  /// Orders numbers, and texts.
  friend std::partial_ordering operator<=>(const Json& a, const Json& b);
  friend std::ostream& operator<<(std::ostream& out, const Json& json);

 private:
  class Builder;
  class Writer;
  enum class Kind : std::uint8_t {
    kNull,
    kBoolean,
    kInteger,
    kUnsigned,
    kReal,
    kText,  // from here on in memory of its own
    kArray,
    kObject
  };
  union Content {
    std::uint64_t natural;
    std::int64_t integer;
    double real;
    bool truth;
    std::string* text;
    Array* array;
    Object* object;
  };

  void release() noexcept;
  template <class T>
  T number() const;
  std::int64_t to_integer() const;
  std::uint64_t to_natural() const;
  double to_real() const;
  bool to_truth() const;
  Array& list();
  Object& members();
  [[noreturn]] void refuse(const char* wanted) const;

  Kind kind_ = Kind::kNull;
  Content content_ = {};
};

struct Json::Member {
  std::string name;
  Json value;
};

/// What stands in braces: lists in braces are made without copies of what they hold.
class Json::Item {
 public:
  template <class T>
  // Constrained to what a Json is made of: else it would stand in for the copy constructor.
  requires std::constructible_from<Json, T> Item(T&& value) : value_(std::forward<T>(value)) {}
  Item(std::initializer_list<Item> items) : value_(items) {}

 private:
  friend class Json;
  mutable Json value_;
};

template <class T>
Json::Json(const std::vector<T>& values) : Json(Array(values.begin(), values.end())) {}

template <class T>
T Json::get() const {
  if constexpr (std::is_same_v<T, bool>) {
    return to_truth();
  } else if constexpr (std::is_enum_v<T>) {
    return static_cast<T>(get<std::underlying_type_t<T>>());
  } else if constexpr (std::floating_point<T>) {
    return static_cast<T>(to_real());
  } else if constexpr (std::signed_integral<T>) {
    return static_cast<T>(to_integer());
  } else if constexpr (std::unsigned_integral<T>) {
    return static_cast<T>(to_natural());
  } else if constexpr (std::is_same_v<T, std::string>) {
    return text();
  } else if constexpr (std::is_same_v<T, Json>) {
    return *this;
  } else {
    if (!is_array()) refuse("a list");
    T values;
    values.reserve(size());
    for (const Json& value : *this) values.push_back(value.get<typename T::value_type>());
    return values;
  }
}

template <class T>
T Json::value(std::string_view name, T fallback) const {
  if (!is_object()) refuse("an object");
  const Json* const member = find(name);
  return member == nullptr ? std::move(fallback) : member->get<T>();
}

}  // namespace screed
