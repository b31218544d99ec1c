// Tables of Wireshark's Signal PDU dissector.
#include "tools/schema/wireshark_tables.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "tools/schema/code_text.h"
#include "tools/schema/schema_check.h"

namespace screed::schema {
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
