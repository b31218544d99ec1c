// Searches an order of an image's functions with few long calls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/avr/order/image_calls.h"

namespace screed::avr_order {

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
