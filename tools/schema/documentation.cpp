// The messages as tables for people.
#include "tools/schema/documentation.h"

#include "host_sim/core/errors.h"
#include "tools/schema/code_text.h"
#include "tools/schema/schema_check.h"

namespace screed::schema {
namespace {

constexpr const char* kBegin = "<!-- messages: made by `make telemetry-page` -->\n";
constexpr const char* kEnd = "<!-- end of messages -->\n";

std::string rate(const DbcMessage& message) {
  if (message.period_ms() == 0) return "on occasion";
  Decimal hz = {10000 / message.period_ms(), 1};
  if (hz.mantissa % 10 == 0) hz = {hz.mantissa / 10, 0};
  return hz.text() + " Hz";
}

std::string type(const DbcSignal& signal) {
  return (signal.is_signed ? "s" : "u") + std::to_string(signal.length);
}

std::string unit(const DbcSignal& signal) {
  if (signal.unit.empty()) return "";
  const std::string step = signal.scale.text() == "1" ? "" : signal.scale.text() + " ";
  const std::string offset = signal.offset.mantissa == 0 ? "" : " from " + signal.offset.text();
  return step + signal.unit + offset;
}

std::string meaning(const DbcMessage& message, const DbcSignal& signal) {
  if (is_protection(message, signal)) return "protection";
  std::string text;
  for (const ValueName& value : signal.values) {
    text += (text.empty() ? "" : ", ") + std::to_string(value.value) + " `" + value.name + "`";
  }
  if (!text.empty() && !signal.comment.empty()) text += "; ";
  text += signal.comment;
  if (!signal.flags().empty()) text += " (" + signal.flags() + ")";
  return text;
}

std::string table_of_messages(const Database& database) {
  std::string text =
      "| id, robot 1 | message | from | rate | bytes | |\n| --- | --- | --- | --- | --- | --- |\n";
  for (const DbcMessage& message : database.messages) {
    text += "| " + id_text(message.id) + " | " + message.name + " | " +
            (message.from_ground() ? "ground" : "robot") + " | " + rate(message) + " | " +
            std::to_string(message.size) + " | " + message.comment + " |\n";
  }
  return text;
}

std::string table_of_signals(const Database& database) {
  std::string text =
      "| message | signal | bits | type | unit | range | |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const DbcMessage& message : database.messages) {
    std::string name = message.name;
    for (const DbcSignal& signal : message.signals) {
      if (is_protection(message, signal)) continue;
      const bool ranged = !signal.unit.empty();
      text += "| " + name + " | " + signal.name + " | " + std::to_string(signal.start) +
              (signal.length == 1 ? "" : ".." + std::to_string(signal.start + signal.length - 1)) +
              " | " + type(signal) + " | " + unit(signal) + " | " +
              (ranged ? signal.minimum.text() + " .. " + signal.maximum.text() : "") + " | " +
              meaning(message, signal) + " |\n";
      name.clear();
    }
  }
  return text;
}

}  // namespace

std::string renewed_page(const std::string& file, const std::string& page,
                         const Database& database) {
  const size_t begin = page.find(kBegin);
  const size_t end = page.find(kEnd);
  if (begin == std::string::npos || end == std::string::npos || end < begin) {
    throw InputError(file + ": has not the lines \"" +
                     std::string(kBegin).substr(0, std::string(kBegin).size() - 1) + "\" and \"" +
                     std::string(kEnd).substr(0, std::string(kEnd).size() - 1) + "\"");
  }
  return page.substr(0, begin) + kBegin + "\n" + table_of_messages(database) + "\n" +
         table_of_signals(database) + "\n" + page.substr(end);
}

}  // namespace screed::schema
