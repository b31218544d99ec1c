// Reads what `avr-objdump -d` prints: instructions and symbols of a linked AVR image.
// Knows the text format and nothing of stacks.
#pragma once

#include <cstdint>
#include <istream>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace screed::avr_stack {

struct Instruction {
  std::uint32_t address = 0;            ///< byte address in flash
  std::uint32_t size = 0;               ///< 2 or 4 bytes
  std::string mnemonic;                 ///< "call", "sbiw", ...
  std::vector<std::string> operands;    ///< as printed, without comment: "r28", "0x3d", "Y+"
  std::optional<std::uint32_t> target;  ///< byte address that a jump, branch or call leads to

  std::uint32_t next() const { return address + size; }
};

class Disassembly {
 public:
  /// Reads the whole stream. Lines that are neither a symbol nor an instruction are skipped.
  /// Throws InputError when there is no instruction at all.
  static Disassembly read(std::istream& in);

  /// All instructions, by address.
  const std::map<std::uint32_t, Instruction>& instructions() const { return instructions_; }

  /// The instruction that starts at `address`; nullptr when none does.
  const Instruction* at(std::uint32_t address) const;

  /// Name of the symbol that holds `address`, demangled; its address in hex when none does.
  std::string name_of(std::uint32_t address) const;

  /// As name_of(), without the " [clone ...]" of a copy that the compiler made.
  std::string plain_name_of(std::uint32_t address) const;

  /// Addresses of the symbols with this plain name; all that begin with it when it ends in '*'.
  std::vector<std::uint32_t> find(const std::string& plain_name) const;

  /// First and one-past-last address of a symbol (mangled name); nothing when there is none.
  struct Range {
    std::uint32_t begin;
    std::uint32_t end;
  };
  std::optional<Range> range_of(const std::string& symbol) const;

 private:
  std::map<std::uint32_t, Instruction> instructions_;
  std::map<std::uint32_t, std::string> symbols_;
};

}  // namespace screed::avr_stack
