// JSON as text, read and written by the library.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "host_sim/core/json.h"

namespace screed {

/// Makes a value of what the library reads, piece by piece.
class Json::Builder {
 public:
  Json take() { return std::move(root_); }

  // Called by the library; false ends the reading.
  bool null() { return put(nullptr); }
  bool boolean(bool value) { return put(value); }
  bool number_integer(std::int64_t value) { return put(value); }
  bool number_unsigned(std::uint64_t value) { return put(value); }
  bool number_float(double value, const std::string& /*digits*/) { return put(value); }
  bool string(std::string& value) { return put(std::move(value)); }
  bool binary(nlohmann::json::binary_t& /*value*/) { return false; }
  bool start_array(std::size_t /*count*/) { return open(Json::array()); }
  bool end_array() { return close(); }
  bool start_object(std::size_t /*count*/) { return open(Json::object()); }
  bool key(std::string& name) {
    open_.back()->content_.object->push_back({std::move(name), {}});
    return true;
  }
  bool end_object() {
    drop_repeated(*open_.back()->content_.object);
    return close();
  }
  bool parse_error(std::size_t byte, const std::string& token,
                   const nlohmann::json::exception& error) {
    constexpr int kNumberOverflow = 406;  // the library's exception out_of_range.406
    throw JsonSyntaxError(
        error.id == kNumberOverflow ? token + " is too large for a number" : "is no JSON", byte);
  }

 private:
  Json& place() {
    if (open_.empty()) return root_;
    Json& inner = *open_.back();
    return inner.is_array() ? inner.content_.array->emplace_back()
                            : inner.content_.object->back().value;
  }
  bool put(Json value) {
    place() = std::move(value);
    return true;
  }
  bool open(Json value) {
    Json& here = place();
    here = std::move(value);
    open_.push_back(&here);
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  /// Of members of one name the first gets the last one's value and the others go. By sorting,
  /// since a file may have many members.
  static void drop_repeated(Object& members) {
    if (members.size() < 2) return;
    std::vector<std::size_t> order(members.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return members[a].name < members[b].name;
    });
    std::vector<bool> goes(members.size());
    for (std::size_t i = 1, first = 0; i < order.size(); ++i) {
      Member& kept = members[order[first]];
      Member& other = members[order[i]];
      if (other.name == kept.name) {
        kept.value = std::move(other.value);
        goes[order[i]] = true;
      } else {
        first = i;
      }
    }
    std::size_t left = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (!goes[i] && left++ != i) members[left - 1] = std::move(members[i]);
    }
    members.resize(left);
  }

  Json root_;
  std::vector<Json*> open_;  ///< lists and objects whose end is still to come; none of them moves
};

namespace {

template <class Builder, class Input>
Json read(Input&& input, bool comments) {
  Builder builder;
  nlohmann::json::sax_parse(std::forward<Input>(input), &builder,
                            nlohmann::json::input_format_t::json, true, comments);
  return builder.take();
}

}  // namespace

Json Json::parse(std::string_view text, bool comments) {
  return read<Builder>(text, comments);
}

Json Json::parse_or_null(std::string_view text) {
  try {
    return parse(text);
  } catch (const JsonSyntaxError&) {
    return nullptr;
  }
}

Json Json::parse_or_null(std::istream& stream) {
  try {
    return read<Builder>(stream, false);
  } catch (const JsonSyntaxError&) {
    return nullptr;
  }
}

class Json::Writer {
 public:
  Writer(int indent, BadText bad_text) : indent_(indent), bad_text_(bad_text) {}

  std::string take() { return std::move(text_); }

  void put(const Json& json) {
    switch (json.kind_) {
      case Kind::kNull:
        text_ += "null";
        break;
      case Kind::kBoolean:
        text_ += json.content_.truth ? "true" : "false";
        break;
      case Kind::kInteger:
        put_integer(json.content_.integer);
        break;
      case Kind::kUnsigned:
        put_integer(json.content_.natural);
        break;
      case Kind::kReal:
        put_real(json.content_.real);
        break;
      case Kind::kText:
        put_text(*json.content_.text);
        break;
      case Kind::kArray:
        put_all(*json.content_.array, '[', ']', [this](const Json& value) { put(value); });
        break;
      case Kind::kObject:
        put_all(*json.content_.object, '{', '}', [this](const Member& member) {
          put_text(member.name);
          text_ += indent_ < 0 ? ":" : ": ";
          put(member.value);
        });
        break;
    }
  }

 private:
  template <class Values, class Put>
  void put_all(const Values& values, char begin, char end, Put put_one) {
    text_ += begin;
    ++depth_;
    for (const auto& value : values) {
      if (&value != values.data()) text_ += ',';
      end_line();
      put_one(value);
    }
    --depth_;
    if (!values.empty()) end_line();
    text_ += end;
  }
  void end_line() {
    if (indent_ < 0) return;
    text_ += '\n';
    text_.append(static_cast<std::size_t>(indent_) * depth_, ' ');
  }
  template <class Integer>
  void put_integer(Integer value) {
    text_.append(digits_, std::to_chars(digits_, digits_ + sizeof digits_, value).ptr);
  }
  void put_real(double value) {
    if (!std::isfinite(value)) {
      text_ += "null";
      return;
    }
    text_.append(digits_, nlohmann::detail::to_chars(digits_, digits_ + sizeof digits_, value));
  }
  void put_text(const std::string& text) {
    const bool plain = std::all_of(text.begin(), text.end(), [](char c) {
      return c >= ' ' && c <= '~' && c != '"' && c != '\\';
    });
    if (plain) {
      text_ += '"';
      text_ += text;
      text_ += '"';
      return;
    }
    using Handler = nlohmann::json::error_handler_t;
    try {
      text_ += nlohmann::json(text).dump(
          -1, ' ', false, bad_text_ == BadText::kReplace ? Handler::replace : Handler::strict);
    } catch (const nlohmann::json::exception& error) {
      throw JsonError(error.what());
    }
  }

  int indent_;
  BadText bad_text_;
  std::size_t depth_ = 0;
  char digits_[64];  ///< of a number; here, for a short stack in each level
  std::string text_;
};

std::string Json::dump(int indent, BadText bad_text) const {
  Writer writer(indent, bad_text);
  writer.put(*this);
  return writer.take();
}

}  // namespace screed
