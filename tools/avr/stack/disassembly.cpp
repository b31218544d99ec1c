// Reads what `avr-objdump -d` prints.
#include "tools/avr/stack/disassembly.h"

#include <cxxabi.h>

#include <charconv>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "host_sim/core/errors.h"

namespace screed::avr_stack {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// The whole of `text` as hexadecimal number.
std::optional<std::uint32_t> hexadecimal(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (error != std::errc{} || end != text.data() + text.size() || text.empty()) return {};
  return value;
}

/// "0000459c <main>:" as address and name.
std::optional<std::pair<std::uint32_t, std::string>> symbol_line(std::string_view line) {
  if (line.size() < 12 || !line.ends_with(">:")) return {};
  const auto open = line.find(" <");
  if (open == std::string_view::npos) return {};
  const auto address = hexadecimal(line.substr(0, open));
  if (!address) return {};
  return std::pair{*address, std::string(line.substr(open + 2, line.size() - open - 4))};
}

/// The part of `rest` up to the next tab, which is taken off `rest`.
std::string_view next_field(std::string_view& rest) {
  const auto tab = rest.find('\t');
  const std::string_view field = rest.substr(0, tab);
  rest = tab == std::string_view::npos ? std::string_view{} : rest.substr(tab + 1);
  return trimmed(field);
}

/// Where "0x459c" or ".-10" leads to, seen from an instruction that ends at `next`.
std::optional<std::uint32_t> destination(std::string_view operand, std::uint32_t next) {
  if (operand.starts_with("0x")) return hexadecimal(operand.substr(2));
  if (operand.size() < 3 || operand[0] != '.') return {};
  int offset = 0;
  const char* const end = operand.data() + operand.size();
  if (std::from_chars(operand.data() + 2, end, offset).ptr != end) return {};
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(next) +
                                    (operand[1] == '-' ? -offset : offset));
}

bool leads_elsewhere(std::string_view mnemonic) {
  return mnemonic == "call" || mnemonic == "rcall" || mnemonic == "jmp" || mnemonic == "rjmp" ||
         (mnemonic.starts_with("br") && mnemonic != "break");
}

/// "  b0:\tcf ef       \tldi\tr28, 0xFF\t; 255"
std::optional<Instruction> instruction_line(std::string_view line) {
  std::string_view rest = line;
  std::string_view address = next_field(rest);
  if (!address.ends_with(':')) return {};
  address.remove_suffix(1);
  const auto at = hexadecimal(address);
  const std::string_view bytes = next_field(rest);
  const std::string_view mnemonic = next_field(rest);
  if (!at || mnemonic.empty()) return {};

  Instruction result;
  result.address = *at;
  result.size = static_cast<std::uint32_t>((bytes.size() + 1) / 3);
  result.mnemonic = mnemonic;
  std::string_view operands = rest.substr(0, rest.find(';'));
  while (!trimmed(operands).empty()) {
    const auto comma = operands.find(',');
    result.operands.emplace_back(trimmed(operands.substr(0, comma)));
    operands = comma == std::string_view::npos ? std::string_view{} : operands.substr(comma + 1);
  }
  if (leads_elsewhere(mnemonic) && !result.operands.empty()) {
    result.target = destination(result.operands.back(), result.next());
  }
  return result;
}

std::string demangled(const std::string& name) {
  if (!name.starts_with("_Z")) return name;  // "f" alone would be the type float
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(
      abi::__cxa_demangle(name.c_str(), nullptr, nullptr, &status), &std::free);
  return status == 0 && text != nullptr ? std::string(text.get()) : name;
}

}  // namespace

Disassembly Disassembly::read(std::istream& in) {
  Disassembly result;
  std::string line;
  while (std::getline(in, line)) {
    const std::string_view text = trimmed(line);
    if (auto symbol = symbol_line(text)) {
      result.symbols_.insert(*symbol);
    } else if (auto instruction = instruction_line(text)) {
      result.instructions_.emplace(instruction->address, std::move(*instruction));
    }
  }
  if (result.instructions_.empty()) {
    throw InputError("no AVR instruction in the input; expected the output of `avr-objdump -d`");
  }
  return result;
}

const Instruction* Disassembly::at(std::uint32_t address) const {
  const auto found = instructions_.find(address);
  return found == instructions_.end() ? nullptr : &found->second;
}

std::string Disassembly::name_of(std::uint32_t address) const {
  auto after = symbols_.upper_bound(address);
  if (after != symbols_.begin()) return demangled(std::prev(after)->second);
  char text[16];
  const auto end = std::to_chars(text, text + sizeof(text), address, 16).ptr;
  return "0x" + std::string(text, end);
}

std::string Disassembly::plain_name_of(std::uint32_t address) const {
  const std::string name = name_of(address);
  return name.substr(0, name.find(" [clone "));
}

std::vector<std::uint32_t> Disassembly::find(const std::string& plain_name) const {
  const bool prefix = plain_name.ends_with('*');
  const std::string_view wanted =
      std::string_view(plain_name).substr(0, plain_name.size() - (prefix ? 1 : 0));
  std::vector<std::uint32_t> result;
  for (const auto& [address, symbol] : symbols_) {
    const std::string name = plain_name_of(address);
    if (prefix ? symbol.starts_with(wanted) || name.starts_with(wanted) : name == wanted) {
      result.push_back(address);
    }
  }
  return result;
}

std::optional<Disassembly::Range> Disassembly::range_of(const std::string& symbol) const {
  for (auto at = symbols_.begin(); at != symbols_.end(); ++at) {
    if (at->second != symbol) continue;
    const auto after = std::next(at);
    const std::uint32_t end = after != symbols_.end() ? after->first
                              : instructions_.empty() ? at->first
                                                      : instructions_.rbegin()->second.next();
    return Range{at->first, end};
  }
  return {};
}

}  // namespace screed::avr_stack
