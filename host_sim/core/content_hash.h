// A 128-bit fingerprint of content: equal content gives equal text on every machine, compiler and
// run.
//
// XXH3 over a byte order of our own (little endian, no padding), so that the layout of a struct in
// memory never matters. It finds accidental differences; it is not a defence against forgery.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

struct XXH3_state_s;  // <xxhash.h>, which no user of this header needs

namespace screed {

class ContentHash {
 public:
  ContentHash();
  ContentHash(ContentHash&&) noexcept;
  ContentHash& operator=(ContentHash&&) noexcept;
  ~ContentHash();

  /// Adds bytes as they are, without their number: two calls equal one call with both parts.
  void add_bytes(std::span<const std::uint8_t> bytes);

  /// Adds an integer in its own width, little endian: int16_t 1 and int32_t 1 differ.
  template <std::integral T>
  void add(T value) {
    if constexpr (std::same_as<T, bool>) {
      add_little_endian(value ? 1U : 0U, 1);
    } else {
      add_little_endian(static_cast<std::uint64_t>(static_cast<std::make_unsigned_t<T>>(value)),
                        sizeof(T));
    }
  }

  /// Adds the IEEE 754 bits: 0.0 and -0.0 differ, a NaN equals the NaN with the same bits.
  void add(double value) { add_little_endian(std::bit_cast<std::uint64_t>(value), 8); }

  /// Adds the length (64 bits) and the bytes, so that "ab","c" and "a","bc" differ.
  void add(std::string_view text);
  void add(const char* text) { add(std::string_view(text)); }

  /// The hash of all that was added so far: 32 lower-case hexadecimal digits. More may be added
  /// afterwards.
  std::string hex() const;

 private:
  struct Free {
    void operator()(XXH3_state_s* state) const noexcept;
  };

  void add_little_endian(std::uint64_t bits, std::size_t bytes);

  std::unique_ptr<XXH3_state_s, Free> state_;
};

/// Of several fingerprints one, in their order; of a single one itself.
std::string combined_hash(const std::vector<std::string>& hashes);

}  // namespace screed
