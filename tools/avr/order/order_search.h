// Which functions of an image call which, and how many of these calls are long in a given order of
// the functions. A rcall is 2 bytes shorter than a call and reaches 4 kB.
//
// A model: sections of the sizes that the linker's map names, all calls long, shrunk by what the
// short ones save.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <string>
#include <vector>

#include "tools/avr/stack/disassembly.h"

namespace screed::avr_order {

/// An input section of the image's .text.
struct Section {
  std::uint32_t begin;  ///< byte address in flash
  std::uint32_t size;   ///< bytes
  std::string name;     ///< ".text.main"
  bool movable;         ///< a function; vectors and start-up code stay where they are
};

/// The sections of .text in a linker's map, by address, empty ones left out. Throws InputError
/// where there are none.
std::vector<Section> read_map(std::istream& in);

class ImageCalls {
 public:
  /// Throws InputError where no section is movable.
  ImageCalls(std::vector<Section> sections, const avr_stack::Disassembly& code);

  /// Calls that stay long with the movable sections in this order.
  int long_calls(const std::vector<std::size_t>& order);

  /// The order that the image has: indices of its movable sections.
  const std::vector<std::size_t>& order() const { return order_; }

  const std::string& name(std::size_t section) const { return sections_[section].name; }

  /// Calls and jumps from one section to another.
  std::size_t calls() const { return calls_.size(); }

 private:
  struct Call {
    std::size_t from, to;
    double from_offset, to_offset;
  };

  std::size_t section_at(std::uint32_t address) const;

  std::vector<Section> sections_;
  std::vector<Call> calls_;
  std::vector<double> places_;
  std::vector<std::size_t> order_;
  double begin_ = 0.0;
};

// Searches an order of an image's functions with few long calls.

struct FunctionOrder {
  std::vector<std::size_t> sections;  ///< as ImageCalls::order()
  int long_calls;
};

/// The best order of `searches` simulated annealings (they end up to a fifth apart), each of so
/// many moves, that begin with the order that the image has. Never worse than that one.
FunctionOrder best_order(ImageCalls& image, std::uint64_t searches, int moves);

/// A section's name as a linker script names it: without what the compiler numbers anew with every
/// change, ".text.f.isra.0" as ".text.f*".
std::string pattern_of(const std::string& section);

}  // namespace screed::avr_order
