// The messages as tables for the host.
#include "tools/schema/host_tables.h"

#include <algorithm>

#include "tools/schema/code_text.h"
#include "tools/schema/schema_check.h"

namespace screed::schema {
namespace {

std::string quoted(const std::string& text) {
  return "\"" + text + "\"";
}

std::string values_name(const DbcMessage& message, const DbcSignal& signal) {
  return "k" + pascal_case(message.name) + pascal_case(signal.name) + "Values";
}

std::string number_at(Decimal number, int decimals) {
  for (; number.decimals < decimals; ++number.decimals) number.mantissa *= 10;
  return std::to_string(number.mantissa);
}

std::string role(const DbcMessage& message, const DbcSignal& signal) {
  if (!is_protection(message, signal)) return "SignalRole::kData";
  return signal.name == "crc" ? "SignalRole::kCrc" : "SignalRole::kCounter";
}

std::string signal_row(const DbcMessage& message, const DbcSignal& signal) {
  const int decimals = std::max(signal.scale.decimals, signal.offset.decimals);
  return "    {" + quoted(signal.name) + ", " + quoted(signal.unit) + ", " +
         quoted(signal.flags()) + ", " + quoted(signal.comment) + ", " + role(message, signal) +
         ", " + std::to_string(signal.start) + ", " + std::to_string(signal.length) + ", " +
         (signal.is_signed ? "true" : "false") + ", " + std::to_string(decimals) + ", " +
         number_at(signal.scale, decimals) + ", " + number_at(signal.offset, decimals) + ", " +
         (signal.values.empty() ? "{}" : values_name(message, signal)) + "},\n";
}

}  // namespace

std::string host_tables(const Database& database) {
  std::string text = "// " + made_from(database) +
                     "\n#pragma once\n\n#include \"host_sim/ground_station/telemetry/schema.h\"\n\n"
                     "namespace screed::schema_tables {\n\n";
  for (const DbcMessage& message : database.messages) {
    for (const DbcSignal& signal : message.signals) {
      if (signal.values.empty()) continue;
      text += "constexpr ValueInfo " + values_name(message, signal) + "[] = {";
      for (const ValueName& value : signal.values) {
        text += "{" + std::to_string(value.value) + ", " + quoted(value.name) + "}, ";
      }
      text.resize(text.size() - 2);
      text += "};\n";
    }
    text += "constexpr SignalInfo k" + pascal_case(message.name) + "Signals[] = {\n";
    for (const DbcSignal& signal : message.signals) text += signal_row(message, signal);
    text += "};\n";
  }
  text += "\nconstexpr MessageInfo kMessages[] = {\n";
  for (const DbcMessage& message : database.messages) {
    text += "    {" + quoted(message.name) + ", " + quoted(small_letters(message.name)) + ", " +
            quoted(message.comment) + ", " + id_text(message.id) + ", " +
            std::to_string(message.size) + ", " + std::to_string(message.period_ms()) + ", " +
            (message.from_ground() ? "true" : "false") + ", " +
            (message.protected_by_crc() ? "true" : "false") + ", k" + pascal_case(message.name) +
            "Signals},\n";
  }
  return text + "};\n\n}  // namespace screed::schema_tables\n";
}

}  // namespace screed::schema
