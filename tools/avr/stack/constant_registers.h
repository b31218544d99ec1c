// Which of the registers X (r26, r27) and Z (r30, r31) hold a known constant: gcc hands the shared
// prologues and epilogues of -mcall-prologues the size of the frame and the way back in them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "tools/avr/stack/disassembly.h"

namespace screed::avr_stack {

class ConstantRegisters {
 public:
  /// Follows one instruction.
  void step(const Instruction& instruction);

  /// The value of a register; nothing when it is unknown, or not one of the four. r1 is 0.
  std::optional<std::int32_t> value_of(std::string_view name) const;

  /// The byte address of what an `ijmp` jumps to; nothing when Z is unknown.
  std::optional<std::uint32_t> jump_target() const;

  /// What is known on both of two paths that meet.
  static ConstantRegisters meet(const ConstantRegisters& a, const ConstantRegisters& b);

  bool operator==(const ConstantRegisters&) const = default;

 private:
  void forget(std::string_view name);

  std::array<std::optional<std::uint8_t>, 4> values_;  ///< r26, r27, r30, r31
};

// What is known of the register pair Y (r28, r29) while a function runs: gcc makes and drops stack
// frames by computing in Y and writing the result to the stack pointer.

class FramePointer {
 public:
  /// Follows one instruction that is executed at a stack height (bytes pushed since the entry),
  /// with these constants in X and Z.
  void step(const Instruction& instruction, std::int32_t height,
            const ConstantRegisters& constants);

  /// The stack height that writing Y to the stack pointer would give; nothing when Y is unknown.
  /// A constant, as the start-up code writes it, is an empty stack: height 0.
  std::optional<std::int32_t> as_height() const;

  /// What is known on both of two paths that meet.
  static FramePointer meet(const FramePointer& a, const FramePointer& b);

  bool operator==(const FramePointer&) const = default;

 private:
  enum class Kind : std::uint8_t {
    kUnknown,
    kLowRead,        ///< r28 = low byte of the stack pointer at height value_
    kStack,          ///< Y = the stack pointer at height value_
    kLowSubtracted,  ///< as kStack, with low_ taken off r28 and the borrow pending
    kLowAdded,       ///< as kStack, with low_ added to r28 and the carry pending
    kLowConstant,    ///< r28 = a constant
    kConstant,       ///< Y = a constant
  };

  void set(Kind kind, std::int32_t value = 0, std::int32_t low = 0);

  Kind kind_ = Kind::kUnknown;
  std::int32_t value_ = 0;
  std::int32_t low_ = 0;
};

}  // namespace screed::avr_stack
