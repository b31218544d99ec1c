// Parser of DBC files.
#include "tools/schema/dbc.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>

#include "host_sim/core/errors.h"
#include "tools/schema/tokens.h"

namespace screed::schema {
namespace {

/// What a BA_DEF_ says of an attribute.
struct AttributeType {
  std::vector<std::string> names;  ///< of an ENUM; empty: no ENUM
  std::string fallback;
};

class Parser {
 public:
  Parser(const std::string& file, const std::string& text) : tokens_(tokens_of(file, text)) {
    database_.file = file;
  }

  Database parse() {
    while (peek().kind != Token::Kind::kEnd) statement();
    for (DbcMessage& message : database_.messages) {
      add_fallbacks("BO_", message.attributes);
      for (DbcSignal& signal : message.signals) add_fallbacks("SG_", signal.attributes);
    }
    return database_;
  }

 private:
  using Kind = Token::Kind;

  const Token& peek() const { return tokens_[at_]; }
  const Token& take() { return tokens_[at_].kind == Kind::kEnd ? tokens_[at_] : tokens_[at_++]; }
  [[noreturn]] void fail(const Token& token, const std::string& what) const {
    throw InputError(database_.file + ":" + std::to_string(token.line) + ": " + what);
  }
  bool is(const char* text) const {
    return (peek().kind == Kind::kSign || peek().kind == Kind::kWord) && peek().text == text;
  }
  const Token& want(Kind kind, const char* what) {
    if (peek().kind != kind) {
      fail(peek(), std::string(what) + " belongs here, not '" + peek().text + "'");
    }
    return take();
  }
  void want(const char* sign) {
    if (!is(sign))
      fail(peek(), "'" + std::string(sign) + "' belongs here, not '" + peek().text + "'");
    take();
  }
  std::string name() { return want(Kind::kWord, "a name").text; }
  std::string words() { return want(Kind::kString, "a text in quotation marks").text; }

  std::int64_t integer(std::int64_t minimum, std::int64_t maximum) {
    const Token& token = want(Kind::kNumber, "a number");
    std::int64_t value = 0;
    const char* const begin = token.text.data() + (token.text[0] == '+' ? 1 : 0);
    const char* const end = token.text.data() + token.text.size();
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc() || stop != end || value < minimum || value > maximum) {
      fail(token, "'" + token.text + "' is not a whole number from " + std::to_string(minimum) +
                      " to " + std::to_string(maximum));
    }
    return value;
  }

  Decimal decimal() {
    const Token& token = want(Kind::kNumber, "a number");
    const std::string& text = token.text;
    const size_t exponent_at = std::min(text.find_first_of("eE"), text.size());
    const std::string digits = text.substr(0, exponent_at);
    int exponent = 0;
    bool good = digits.find('.') == digits.rfind('.');
    if (exponent_at < text.size()) {
      const char* begin = text.data() + exponent_at + 1;
      if (*begin == '+') ++begin;
      const char* const end = text.data() + text.size();
      const auto [stop, error] = std::from_chars(begin, end, exponent);
      good = good && error == std::errc() && stop == end && std::abs(exponent) < 19;
    }
    Decimal number;
    const size_t point = std::min(digits.find('.'), digits.size());
    std::string mantissa = digits.substr(digits[0] == '+' ? 1 : 0, point);
    if (point < digits.size()) {
      mantissa = digits.substr(0, point) + digits.substr(point + 1);
      number.decimals = static_cast<int>(digits.size() - point - 1);
      if (mantissa[0] == '+') mantissa.erase(0, 1);
    }
    const char* const end = mantissa.data() + mantissa.size();
    const auto [stop, error] = std::from_chars(mantissa.data(), end, number.mantissa);
    good = good && error == std::errc() && stop == end;
    number.decimals -= exponent;
    for (; good && number.decimals < 0; ++number.decimals) {
      good = std::abs(number.mantissa) <= INT64_MAX / 10;
      if (good) number.mantissa *= 10;
    }
    while (number.decimals > 0 && number.mantissa % 10 == 0) {
      number.mantissa /= 10;
      --number.decimals;
    }
    if (!good || number.decimals > 18) {
      fail(token, "'" + text + "' is not a decimal number of at most 18 digits");
    }
    return number;
  }

  void statement() {
    const Token& token = want(Kind::kWord, "a keyword");
    const std::string& keyword = token.text;
    if (keyword == "VERSION") {
      words();
    } else if (keyword == "NS_") {
      want(":");
      // Names of keywords, one a line, up to the next statement.
      const int line = token.line;
      while (peek().kind == Kind::kWord && peek().line > line && !is("BS_")) take();
    } else if (keyword == "BS_") {
      want(":");
    } else if (keyword == "BU_") {
      want(":");
      while (peek().kind == Kind::kWord && peek().line == token.line) {
        database_.nodes.push_back(take().text);
      }
    } else if (keyword == "BO_") {
      message(token.line);
    } else if (keyword == "SG_") {
      fail(token, "a signal outside of a message");
    } else if (keyword == "CM_") {
      comment();
    } else if (keyword == "BA_DEF_") {
      attribute_type();
    } else if (keyword == "BA_DEF_DEF_") {
      const Token& attribute = want(Kind::kString, "the name of an attribute");
      type_of(attribute).fallback = attribute_value(type_of(attribute));
      want(";");
    } else if (keyword == "BA_") {
      attribute();
    } else if (keyword == "VAL_") {
      value_names();
    } else if (keyword == "SIG_VALTYPE_") {
      DbcSignal& it = signal(message_by_id(), "the type of a value");
      if (is(":")) take();
      it.is_float = integer(0, 2) != 0;
      want(";");
    } else {
      fail(token, "'" + keyword +
                      "' is not understood here: VERSION, NS_, BS_, BU_, BO_, SG_, CM_, BA_DEF_, "
                      "BA_DEF_DEF_, BA_, VAL_, SIG_VALTYPE_ are");
    }
  }

  void message(int line) {
    DbcMessage it;
    it.line = line;
    it.id = static_cast<std::uint32_t>(integer(0, UINT32_MAX));
    it.name = name();
    want(":");
    it.size = static_cast<int>(integer(0, 64));
    it.sender = name();
    while (is("SG_")) {
      take();
      it.signals.push_back(signal_line());
    }
    database_.messages.push_back(it);
  }

  DbcSignal signal_line() {
    DbcSignal it;
    it.line = peek().line;
    it.name = name();
    if (peek().kind == Kind::kWord) it.multiplexer = take().text;
    want(":");
    it.start = static_cast<int>(integer(0, 511));
    want("|");
    it.length = static_cast<int>(integer(1, 512));
    want("@");
    const Token& order = want(Kind::kNumber, "the byte order, 1 or 0,");
    it.little_endian = order.text == "1";
    if (order.text != "1" && order.text != "0") fail(order, "the byte order is 1 or 0");
    it.is_signed = is("-");
    if (!it.is_signed && !is("+")) fail(peek(), "the sign, + or -, belongs here");
    take();
    want("(");
    it.scale = decimal();
    want(",");
    it.offset = decimal();
    want(")");
    want("[");
    it.minimum = decimal();
    want("|");
    it.maximum = decimal();
    want("]");
    it.unit = words();
    do {
      if (is(",")) take();
      name();  // a receiver
    } while (is(","));
    return it;
  }

  DbcMessage& message_by_id() {
    const Token& token = peek();
    const std::int64_t id = integer(0, UINT32_MAX);
    const auto found = std::find_if(database_.messages.begin(), database_.messages.end(),
                                    [&](const DbcMessage& it) { return it.id == id; });
    if (found == database_.messages.end()) fail(token, "no message has the id " + token.text);
    return *found;
  }

  DbcSignal& signal(DbcMessage& message, const char* what) {
    const Token& token = peek();
    const std::string wanted = name();
    const auto found = std::find_if(message.signals.begin(), message.signals.end(),
                                    [&](const DbcSignal& it) { return it.name == wanted; });
    if (found == message.signals.end()) {
      fail(token, std::string(what) + " is given for " + message.name + "." + wanted +
                      ", which is not there");
    }
    return *found;
  }

  void comment() {
    if (is("BO_")) {
      take();
      DbcMessage& it = message_by_id();
      it.comment = words();
    } else if (is("SG_")) {
      take();
      DbcSignal& it = signal(message_by_id(), "a comment");
      it.comment = words();
    } else if (is("BU_")) {
      take();
      name();
      words();
    } else {
      database_.comment = words();
    }
    want(";");
  }

  void attribute_type() {
    std::string of;
    if (is("BO_") || is("SG_") || is("BU_")) of = take().text;
    const Token& token = want(Kind::kString, "the name of an attribute");
    AttributeType type;
    const std::string kind = name();
    if (kind == "ENUM") {
      type.names.push_back(words());
      while (is(",")) {
        take();
        type.names.push_back(words());
      }
    } else if (kind == "INT" || kind == "HEX" || kind == "FLOAT") {
      while (peek().kind == Kind::kNumber) decimal();
    } else if (kind != "STRING") {
      fail(token, "an attribute is INT, HEX, FLOAT, ENUM or STRING, not " + kind);
    }
    want(";");
    if (!types_.emplace(token.text, type).second) {
      fail(token, "the attribute \"" + token.text + "\" is defined twice");
    }
    owners_[of].insert(token.text);
  }

  AttributeType& type_of(const Token& name) {
    const auto found = types_.find(name.text);
    if (found == types_.end()) fail(name, "no attribute \"" + name.text + "\" is defined");
    return found->second;
  }

  std::string attribute_value(const AttributeType& type) {
    const Token& token = take();
    if (type.names.empty()) {
      if (token.kind != Kind::kNumber && token.kind != Kind::kString) {
        fail(token, "the value of an attribute belongs here, not '" + token.text + "'");
      }
      return token.text;
    }
    if (token.kind == Kind::kString) {
      if (std::find(type.names.begin(), type.names.end(), token.text) != type.names.end()) {
        return token.text;
      }
    } else if (token.kind == Kind::kNumber) {
      for (size_t i = 0; i < type.names.size(); ++i) {
        if (token.text == std::to_string(i)) return type.names[i];
      }
    }
    fail(token, "'" + token.text + "' is not a value of this attribute");
  }

  void attribute() {
    const Token& attribute = want(Kind::kString, "the name of an attribute");
    const AttributeType& type = type_of(attribute);
    if (is("BO_")) {
      take();
      DbcMessage& it = message_by_id();
      it.attributes[attribute.text] = attribute_value(type);
    } else if (is("SG_")) {
      take();
      DbcSignal& it = signal(message_by_id(), "an attribute");
      it.attributes[attribute.text] = attribute_value(type);
    } else if (is("BU_")) {
      take();
      name();
      attribute_value(type);
    } else {
      attribute_value(type);
    }
    want(";");
  }

  void value_names() {
    const int line = peek().line;
    DbcSignal& it = signal(message_by_id(), "names of values");
    it.values_line = line;
    while (!is(";")) {
      const int value_line = peek().line;
      const std::int64_t value = integer(INT32_MIN, UINT32_MAX);
      it.values.push_back({value, words(), value_line});
    }
    want(";");
  }

  void add_fallbacks(const std::string& of, std::map<std::string, std::string>& attributes) {
    for (const std::string& name : owners_[of]) attributes.emplace(name, types_[name].fallback);
  }

  std::vector<Token> tokens_;
  size_t at_ = 0;
  Database database_;
  std::map<std::string, AttributeType> types_;
  std::map<std::string, std::set<std::string>> owners_;  ///< BO_, SG_, ...: names of attributes
};

std::string attribute(const std::map<std::string, std::string>& attributes, const char* name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? "" : found->second;
}

}  // namespace

double Decimal::value() const {
  return static_cast<double>(mantissa) / std::pow(10.0, decimals);
}

std::string Decimal::text() const {
  const bool negative = mantissa < 0;
  std::string digits = std::to_string(negative ? 0 - static_cast<std::uint64_t>(mantissa)
                                               : static_cast<std::uint64_t>(mantissa));
  const auto after = static_cast<size_t>(decimals);
  if (digits.size() <= after) digits.insert(0, after + 1 - digits.size(), '0');
  if (after > 0) digits.insert(digits.size() - after, ".");
  return (negative ? "-" : "") + digits;
}

std::string DbcSignal::flags() const {
  return attribute(attributes, "Flags");
}

std::string DbcSignal::class_folder() const {
  return attribute(attributes, "ClassFolder");
}

bool DbcMessage::from_ground() const {
  return sender == "GROUND";
}

bool DbcMessage::protected_by_crc() const {
  return attribute(attributes, "Protection") == "e2e";
}

int DbcMessage::period_ms() const {
  const std::string text = attribute(attributes, "GenMsgCycleTime");
  int value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

Database parse_dbc(const std::string& file, const std::string& text) {
  return Parser(file, text).parse();
}

Database read_dbc(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in) throw InputError(file + ": cannot be read");
  return parse_dbc(file, text);
}

}  // namespace screed::schema
