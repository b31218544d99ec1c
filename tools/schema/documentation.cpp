// The messages as tables for people.
#include "tools/schema/documentation.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "host_sim/core/errors.h"
#include "tools/schema/code.h"
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

// Tables of Wireshark's Signal PDU dissector.

namespace {

std::string hex(std::uint64_t value) {
  char text[20];
  std::snprintf(text, sizeof text, "%llx", static_cast<unsigned long long>(value));
  return text;
}

/// A line of a table: every value in quotation marks.
std::string row(const std::vector<std::string>& values) {
  std::string line;
  for (const std::string& value : values) line += (line.empty() ? "\"" : ",\"") + value + "\"";
  return line + "\n";
}

/// What the dissector reads one after the other: signals, and the gaps between them.
struct Entry {
  const DbcSignal* signal;  ///< null: a gap
  int bits;
};

std::vector<Entry> entries_of(const DbcMessage& message) {
  std::vector<const DbcSignal*> signals;
  for (const DbcSignal& signal : message.signals) signals.push_back(&signal);
  std::sort(signals.begin(), signals.end(),
            [](const DbcSignal* a, const DbcSignal* b) { return a->start < b->start; });
  std::vector<Entry> entries;
  int bit = 0;
  for (const DbcSignal* signal : signals) {
    if (signal->start > bit) entries.push_back({nullptr, signal->start - bit});
    entries.push_back({signal, signal->length});
    bit = signal->start + signal->length;
  }
  if (bit < 8 * message.size) entries.push_back({nullptr, 8 * message.size - bit});
  return entries;
}

/// The types that the dissector knows have 8, 16, 32 or 64 bits.
std::string base_bits(int bits) {
  return bits <= 8 ? "8" : bits <= 16 ? "16" : "32";
}

void add_signals(const DbcMessage& message, std::string& signals, std::string& values) {
  const std::vector<Entry> entries = entries_of(message);
  const std::string pdu = hex(message.id);
  for (size_t i = 0; i < entries.size(); ++i) {
    const Entry& entry = entries[i];
    const DbcSignal* const signal = entry.signal;
    const std::string position = std::to_string(i);
    std::string name = signal == nullptr ? "unused" : signal->name;
    if (signal != nullptr && !signal->unit.empty()) name += " [" + signal->unit + "]";
    const std::string filter = small_letters(message.name) + "." +
                               (signal == nullptr ? "unused" + position : signal->name);
    signals += row({pdu, std::to_string(entries.size()), position, name, filter,
                    signal != nullptr && signal->is_signed ? "int" : "uint", "FALSE",
                    base_bits(entry.bits), std::to_string(entry.bits),
                    signal == nullptr ? "1" : signal->scale.text(),
                    signal == nullptr ? "0" : signal->offset.text(), "FALSE", "-1",
                    signal == nullptr ? "TRUE" : "FALSE"});
    if (signal == nullptr) continue;
    for (const ValueName& value : signal->values) {
      const std::string number = hex(static_cast<std::uint64_t>(value.value));
      values +=
          row({pdu, position, std::to_string(signal->values.size()), number, number, value.name});
    }
  }
}

}  // namespace

std::map<std::string, std::string> wireshark_tables(const Database& database) {
  const std::string head = "# " + made_from(database) + "\n";
  std::string names = head;
  std::string signals = head;
  std::string values = head;
  std::string bindings = head;
  for (const DbcMessage& message : database.messages) {
    names += row({hex(message.id), message.name});
    add_signals(message, signals, values);
    const bool of_ground = (message.id >> 4 & 0xFU) == 0;
    for (unsigned node = of_ground ? 0 : 1; node <= (of_ground ? 0U : 15U); ++node) {
      bindings += row({hex((message.id & 0x70FU) | node << 4), "0", hex(message.id)});
    }
  }
  return {{"Signal_PDU_identifiers", names},
          {"Signal_PDU_signal_list", signals},
          {"Signal_PDU_signal_values", values},
          {"Signal_PDU_Binding_CAN", bindings},
          {"preferences", head + "signal_pdu.payload_dissector_activated: TRUE\n"}};
}

}  // namespace screed::schema
