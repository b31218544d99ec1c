// What is known of the register pair Y while a function runs.
#include "tools/avr/stack/frame_pointer.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <string_view>

namespace screed::avr_stack {
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
