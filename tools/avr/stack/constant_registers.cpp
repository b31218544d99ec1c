// Known constants in X and Z.
#include "tools/avr/stack/constant_registers.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <initializer_list>
#include <string>
#include <string_view>

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

// What is known of the register pair Y while a function runs.

namespace {

constexpr std::string_view kLow = "r28";
constexpr std::string_view kHigh = "r29";

/// Instructions whose first operand is only read.
constexpr std::array<std::string_view, 14> kReaders = {"cp",   "cpc",   "cpi",  "cpse", "tst",
                                                       "push", "sbrc",  "sbrs", "bst",  "mul",
                                                       "muls", "mulsu", "fmul", "fmuls"};

std::int32_t number(const Instruction& instruction) {
  if (instruction.operands.size() < 2) return 0;
  return static_cast<std::int32_t>(std::strtol(instruction.operands[1].c_str(), nullptr, 0));
}

/// Heights are differences of 16-bit addresses.
std::int32_t wrap16(std::int32_t value) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(value & 0xFFFF));
}

bool writes_y(const Instruction& instruction) {
  for (const std::string& operand : instruction.operands) {
    if (operand == "Y+" || operand == "-Y") return true;
  }
  if (instruction.operands.empty()) return false;
  const std::string& first = instruction.operands.front();
  if (first != kLow && first != kHigh) return false;
  return std::find(kReaders.begin(), kReaders.end(), instruction.mnemonic) == kReaders.end();
}

}  // namespace

void FramePointer::set(Kind kind, std::int32_t value, std::int32_t low) {
  kind_ = kind;
  value_ = value;
  low_ = low;
}

void FramePointer::step(const Instruction& instruction, std::int32_t height,
                        const ConstantRegisters& constants) {
  if (!writes_y(instruction)) return;
  const std::string& what = instruction.mnemonic;
  const bool low = instruction.operands.front() == kLow;
  const std::int32_t operand = number(instruction);
  const auto second =
      instruction.operands.size() < 2 ? std::nullopt : constants.value_of(instruction.operands[1]);
  const bool known = second.has_value();
  const std::int32_t constant = second.value_or(0);

  if (what == "in" && low && operand == 0x3d) {
    set(Kind::kLowRead, height);
  } else if (what == "in" && !low && operand == 0x3e && kind_ == Kind::kLowRead &&
             value_ == height) {
    set(Kind::kStack, height);
  } else if (what == "sbiw" && low && kind_ == Kind::kStack) {
    set(Kind::kStack, wrap16(value_ + operand));
  } else if (what == "adiw" && low && kind_ == Kind::kStack) {
    set(Kind::kStack, wrap16(value_ - operand));
  } else if (what == "subi" && low && kind_ == Kind::kStack) {
    set(Kind::kLowSubtracted, value_, operand);
  } else if (what == "sbci" && !low && kind_ == Kind::kLowSubtracted) {
    set(Kind::kStack, wrap16(value_ + low_ + operand * 256));
  } else if (what == "sub" && low && kind_ == Kind::kStack && known) {
    set(Kind::kLowSubtracted, value_, constant);
  } else if (what == "sbc" && !low && kind_ == Kind::kLowSubtracted && known) {
    set(Kind::kStack, wrap16(value_ + low_ + constant * 256));
  } else if (what == "add" && low && kind_ == Kind::kStack && known) {
    set(Kind::kLowAdded, value_, constant);
  } else if (what == "adc" && !low && kind_ == Kind::kLowAdded && known) {
    set(Kind::kStack, wrap16(value_ - low_ - constant * 256));
  } else if (what == "ldi" && low) {
    set(Kind::kLowConstant);
  } else if (what == "ldi" && !low && kind_ == Kind::kLowConstant) {
    set(Kind::kConstant);
  } else {
    set(Kind::kUnknown);
  }
}

std::optional<std::int32_t> FramePointer::as_height() const {
  if (kind_ == Kind::kStack) return value_;
  if (kind_ == Kind::kConstant) return 0;
  return {};
}

FramePointer FramePointer::meet(const FramePointer& a, const FramePointer& b) {
  return a == b ? a : FramePointer{};
}

}  // namespace screed::avr_stack
