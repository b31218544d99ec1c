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

}  // namespace screed::avr_stack
