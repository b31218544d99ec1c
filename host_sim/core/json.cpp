// The value: what is single lies in it, texts, lists and objects in memory of their own.
#include "host_sim/core/json.h"

#include <algorithm>
#include <ostream>

namespace screed {

Json::Json(std::string value) : kind_(Kind::kText) {
  content_.text = new std::string(std::move(value));
}

Json::Json(std::string_view value) : Json(std::string(value)) {}

Json::Json(const char* value) : Json(std::string(value)) {}

Json::Json(Array values) : kind_(Kind::kArray) {
  content_.array = new Array(std::move(values));
}

Json::Json(std::initializer_list<Item> items) {
  const bool members = std::all_of(items.begin(), items.end(), [](const Item& item) {
    const Json& pair = item.value_;
    return pair.is_array() && pair.size() == 2 && pair[0].is_string();
  });
  *this = members ? object(items) : array(items);
}

Json::Json(const Json& other) : kind_(other.kind_), content_(other.content_) {
  if (kind_ == Kind::kText) content_.text = new std::string(*other.content_.text);
  if (kind_ == Kind::kArray) content_.array = new Array(*other.content_.array);
  if (kind_ == Kind::kObject) content_.object = new Object(*other.content_.object);
}

/// Lists within lists are released one behind the other: by recursion, brackets of a file would
/// decide how deep the stack goes.
void Json::release() noexcept {
  if (kind_ == Kind::kText) {
    delete content_.text;
    return;
  }
  Array inner;
  const auto take_inner = [&inner](Json& from) {
    if (from.is_array()) {
      for (Json& value : *from.content_.array)
        if (value.is_structured()) inner.push_back(std::move(value));
    } else if (from.is_object()) {
      for (Member& member : *from.content_.object)
        if (member.value.is_structured()) inner.push_back(std::move(member.value));
    }
  };
  take_inner(*this);
  while (!inner.empty()) {
    Json last = std::move(inner.back());
    inner.pop_back();
    take_inner(last);
  }
  if (kind_ == Kind::kArray) delete content_.array;
  if (kind_ == Kind::kObject) delete content_.object;
}

Json Json::object() {
  Json json;
  json.kind_ = Kind::kObject;
  json.content_.object = new Object;
  return json;
}

Json Json::array(std::initializer_list<Item> items) {
  Json json = array();
  json.content_.array->reserve(items.size());
  for (const Item& item : items) json.content_.array->push_back(std::move(item.value_));
  return json;
}

Json Json::object(std::initializer_list<Item> members) {
  Json json = object();
  json.content_.object->reserve(members.size());
  for (const Item& item : members) {
    Array& pair = item.value_.list();
    json[pair.at(0).text()] = std::move(pair.at(1));
  }
  return json;
}

void Json::refuse(const char* wanted) const {
  throw JsonError(dump(-1, BadText::kReplace).substr(0, 40) + " in JSON; wanted is " + wanted);
}

const std::string& Json::text() const {
  if (!is_string()) refuse("a text");
  return *content_.text;
}

template <class T>
T Json::number() const {
  if (kind_ == Kind::kInteger) return static_cast<T>(content_.integer);
  if (kind_ == Kind::kUnsigned) return static_cast<T>(content_.natural);
  if (kind_ == Kind::kReal) return static_cast<T>(content_.real);
  refuse("a number");
}

std::int64_t Json::to_integer() const {
  return number<std::int64_t>();
}
std::uint64_t Json::to_natural() const {
  return number<std::uint64_t>();
}
double Json::to_real() const {
  return number<double>();
}

bool Json::to_truth() const {
  if (!is_boolean()) refuse("true or false");
  return content_.truth;
}

// ---- objects

Json::Object& Json::members() {
  if (is_null()) *this = object();
  if (!is_object()) refuse("an object");
  return *content_.object;
}

const Json::Object& Json::items() const {
  static const Object none;
  if (is_null()) return none;
  if (!is_object()) refuse("an object");
  return *content_.object;
}

const Json* Json::find(std::string_view name) const {
  if (!is_object()) return nullptr;
  const Object& all = *content_.object;
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Member& it) { return it.name == name; });
  return found == all.end() ? nullptr : &found->value;
}

const Json& Json::at(std::string_view name) const {
  if (!is_object()) refuse("an object");
  if (const Json* const found = find(name)) return *found;
  throw JsonError("'" + std::string(name) + "' is missing in JSON");
}

Json& Json::operator[](std::string_view name) {
  Object& all = members();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Member& it) { return it.name == name; });
  if (found != all.end()) return found->value;
  all.push_back({std::string(name), Json()});
  return all.back().value;
}

std::string Json::value(std::string_view name, const char* fallback) const {
  return value(name, std::string(fallback));
}

void Json::update(Json other) {
  for (Member& member : other.members()) (*this)[member.name] = std::move(member.value);
}

void Json::erase(std::string_view name) {
  if (!is_object()) refuse("an object");
  std::erase_if(*content_.object, [&](const Member& it) { return it.name == name; });
}

void Json::sort_members() {
  if (is_array()) {
    for (Json& value : *content_.array) value.sort_members();
  } else if (is_object()) {
    Object& all = *content_.object;
    for (Member& member : all) member.value.sort_members();
    std::sort(all.begin(), all.end(),
              [](const Member& a, const Member& b) { return a.name < b.name; });
  }
}

// ---- lists

Json::Array& Json::list() {
  if (is_null()) *this = array();
  if (!is_array()) refuse("a list");
  return *content_.array;
}

const Json& Json::at(std::size_t index) const {
  if (!is_array()) refuse("a list");
  if (index < size()) return (*content_.array)[index];
  throw JsonError("a list in JSON has " + std::to_string(size()) + " values; wanted is number " +
                  std::to_string(index));
}

Json& Json::operator[](std::size_t index) {
  static_cast<void>(at(index));
  return (*content_.array)[index];
}

Json& Json::back() {
  if (empty()) refuse("a list with values");
  return list().back();
}

void Json::push_back(Json value) {
  list().push_back(std::move(value));
}

const Json* Json::begin() const {
  if (is_null()) return nullptr;
  if (!is_array()) refuse("a list");
  return content_.array->data();
}

const Json* Json::end() const {
  return is_null() ? nullptr : begin() + size();
}

std::size_t Json::size() const {
  if (is_array()) return content_.array->size();
  if (is_object()) return content_.object->size();
  return is_null() ? 0 : 1;
}

// ---- comparison

std::partial_ordering operator<=>(const Json& a, const Json& b) {
  using Kind = Json::Kind;
  if (a.is_string() && b.is_string()) return a.text() <=> b.text();
  if (!a.is_number() || !b.is_number()) return std::partial_ordering::unordered;
  if (a.kind_ == Kind::kReal || b.kind_ == Kind::kReal) return a.to_real() <=> b.to_real();
  const bool a_negative = a.kind_ == Kind::kInteger && a.content_.integer < 0;
  const bool b_negative = b.kind_ == Kind::kInteger && b.content_.integer < 0;
  if (a_negative && b_negative) return a.to_integer() <=> b.to_integer();
  if (a_negative || b_negative) return b_negative <=> a_negative;
  return a.to_natural() <=> b.to_natural();
}

bool operator==(const Json& a, const Json& b) {
  if (a.is_number() && b.is_number()) return std::is_eq(a <=> b);
  if (a.kind_ != b.kind_) return false;
  switch (a.kind_) {
    case Json::Kind::kBoolean:
      return a.content_.truth == b.content_.truth;
    case Json::Kind::kText:
      return *a.content_.text == *b.content_.text;
    case Json::Kind::kArray:
      return *a.content_.array == *b.content_.array;
    case Json::Kind::kObject:
      return std::equal(a.items().begin(), a.items().end(), b.items().begin(), b.items().end(),
                        [](const Json::Member& one, const Json::Member& other) {
                          return one.name == other.name && one.value == other.value;
                        });
    default:
      return true;  // null
  }
}

std::ostream& operator<<(std::ostream& out, const Json& json) {
  return out << json.dump();
}

}  // namespace screed
