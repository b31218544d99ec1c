// XXH3 (128 bits, streaming) of libxxhash behind ContentHash.
#include "host_sim/core/content_hash.h"

#include <xxhash.h>

#include <array>
#include <new>

namespace screed {

void ContentHash::Free::operator()(XXH3_state_s* state) const noexcept {
  XXH3_freeState(state);
}

ContentHash::ContentHash() : state_(XXH3_createState()) {
  if (state_ == nullptr || XXH3_128bits_reset(state_.get()) != XXH_OK) throw std::bad_alloc();
}

ContentHash::ContentHash(ContentHash&&) noexcept = default;
ContentHash& ContentHash::operator=(ContentHash&&) noexcept = default;
ContentHash::~ContentHash() = default;

void ContentHash::add_bytes(std::span<const std::uint8_t> bytes) {
  // An empty span may have a null pointer, which XXH3 would refuse.
  if (!bytes.empty()) XXH3_128bits_update(state_.get(), bytes.data(), bytes.size());
}

void ContentHash::add(std::string_view text) {
  add(static_cast<std::uint64_t>(text.size()));
  if (!text.empty()) XXH3_128bits_update(state_.get(), text.data(), text.size());
}

void ContentHash::add_little_endian(std::uint64_t bits, std::size_t bytes) {
  std::array<std::uint8_t, 8> raw{};
  for (std::size_t i = 0; i < bytes; ++i) raw[i] = static_cast<std::uint8_t>(bits >> (8 * i));
  add_bytes(std::span(raw).first(bytes));
}

std::string ContentHash::hex() const {
  XXH128_canonical_t canonical{};
  XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * sizeof(canonical.digest));
  for (const unsigned char byte : canonical.digest) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::string combined_hash(const std::vector<std::string>& hashes) {
  if (hashes.size() == 1) return hashes.front();
  ContentHash all;
  for (const std::string& hash : hashes) all.add(hash);
  return all.hex();
}

}  // namespace screed
