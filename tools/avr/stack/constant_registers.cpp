// Known constants in X and Z.
#include "tools/avr/stack/constant_registers.h"

#include <algorithm>
#include <cstdlib>
#include <initializer_list>
#include <string>

namespace screed::avr_stack {
namespace {

constexpr std::array<std::string_view, 4> kNames = {"r26", "r27", "r30", "r31"};
// Always zero between the instructions of gcc (avr-gcc ABI).
constexpr std::string_view kZero = "r1";

bool is_any(std::string_view text, std::initializer_list<std::string_view> of) {
  return std::find(of.begin(), of.end(), text) != of.end();
}

std::size_t index_of(std::string_view name) {
  return static_cast<std::size_t>(std::find(kNames.begin(), kNames.end(), name) - kNames.begin());
}

}  // namespace

void ConstantRegisters::forget(std::string_view name) {
  const std::size_t index = index_of(name);
  if (index < values_.size()) values_[index].reset();
}

void ConstantRegisters::step(const Instruction& instruction) {
  const std::string_view what = instruction.mnemonic;
  // All four may change in a called function.
  if (is_any(what, {"call", "rcall", "icall", "eicall"})) values_ = {};
  for (const std::string& operand : instruction.operands) {
    const bool x = is_any(operand, {"X+", "-X"});
    if (!x && !is_any(operand, {"Z+", "-Z"})) continue;
    forget(x ? "r26" : "r30");
    forget(x ? "r27" : "r31");
  }
  // What only reads its first operand forgets it all the same: too little is known then, never
  // wrong.
  if (instruction.operands.empty()) return;
  const std::string& first = instruction.operands.front();
  forget(first);
  if (is_any(what, {"movw", "adiw", "sbiw"})) forget(first == "r26" ? "r27" : "r31");
  const std::size_t index = index_of(first);
  if (what == "ldi" && index < values_.size() && instruction.operands.size() == 2) {
    values_[index] =
        static_cast<std::uint8_t>(std::strtol(instruction.operands[1].c_str(), nullptr, 0));
  }
}

std::optional<std::int32_t> ConstantRegisters::value_of(std::string_view name) const {
  if (name == kZero) return 0;
  const std::size_t index = index_of(name);
  if (index >= values_.size()) return {};
  return values_[index];
}

std::optional<std::uint32_t> ConstantRegisters::jump_target() const {
  const auto low = values_[2];
  const auto high = values_[3];
  if (!low || !high) return {};
  return 2U * (std::uint32_t{*high} * 256U + *low);  // Z counts words
}

ConstantRegisters ConstantRegisters::meet(const ConstantRegisters& a, const ConstantRegisters& b) {
  ConstantRegisters both;
  for (std::size_t i = 0; i < both.values_.size(); ++i) {
    if (a.values_[i] == b.values_[i]) both.values_[i] = a.values_[i];
  }
  return both;
}

}  // namespace screed::avr_stack
