// The content hash: known values, defined byte order, and sensitivity.
#include "host_sim/core/content_hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <vector>

namespace screed {
namespace {

template <class... Values>
std::string hash_of(const Values&... values) {
  ContentHash hash;
  (hash.add(values), ...);
  return hash.hex();
}

std::string hash_of_bytes(const std::vector<std::uint8_t>& bytes) {
  ContentHash hash;
  hash.add_bytes(bytes);
  return hash.hex();
}

// XXH3_128bits of the empty input: XXH_SANITY_TEST "Testing 128-bit variant, length 0" of xxHash,
// printed as xxhsum -H2 does.
TEST(ContentHash, EmptyInputHasThePublishedValue) {
  EXPECT_EQ(ContentHash().hex(), "99aa06d3014798d86001c324468d497f");
}

TEST(ContentHash, IntegersAreLittleEndianInTheirOwnWidth) {
  EXPECT_EQ(hash_of(std::uint32_t{0x04030201}), hash_of_bytes({1, 2, 3, 4}));
  EXPECT_EQ(hash_of(std::int16_t{-2}), hash_of_bytes({0xFE, 0xFF}));
  EXPECT_EQ(hash_of(std::int64_t{-1}), hash_of_bytes(std::vector<std::uint8_t>(8, 0xFF)));
  EXPECT_EQ(hash_of(true), hash_of_bytes({1}));
  EXPECT_NE(hash_of(std::int16_t{1}), hash_of(std::int32_t{1}));
}

TEST(ContentHash, DoublesAreTheirBits) {
  EXPECT_EQ(hash_of(1.0), hash_of_bytes({0, 0, 0, 0, 0, 0, 0xF0, 0x3F}));
  EXPECT_NE(hash_of(0.0), hash_of(-0.0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(hash_of(nan), hash_of(nan));
}

TEST(ContentHash, TextCarriesItsLength) {
  EXPECT_EQ(hash_of("ab"), hash_of_bytes({2, 0, 0, 0, 0, 0, 0, 0, 'a', 'b'}));
  EXPECT_NE(hash_of("ab", "c"), hash_of("a", "bc"));
  EXPECT_NE(hash_of(""), ContentHash().hex());
}

TEST(ContentHash, BlocksOfAnySizeGiveTheSameHash) {
  std::vector<std::uint8_t> bytes(5000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * 31 >> 3);
  const std::string whole = hash_of_bytes(bytes);
  for (const std::size_t block : std::to_array<std::size_t>({1, 7, 64, 1000})) {
    ContentHash hash;
    for (std::size_t at = 0; at < bytes.size(); at += block) {
      hash.add_bytes(std::span(bytes).subspan(at, std::min(block, bytes.size() - at)));
    }
    hash.add_bytes({});
    EXPECT_EQ(hash.hex(), whole) << "blocks of " << block;
  }
}

TEST(ContentHash, EveryByteCounts) {
  std::vector<std::uint8_t> bytes(300, 0);
  std::set<std::string> seen{hash_of_bytes(bytes)};
  for (std::uint8_t& byte : bytes) {
    byte = 1;
    EXPECT_TRUE(seen.insert(hash_of_bytes(bytes)).second);
    byte = 0;
  }
}

TEST(ContentHash, AskingDoesNotEndTheHash) {
  ContentHash hash;
  hash.add(1);
  EXPECT_EQ(hash.hex(), hash_of(1));
  hash.add(2);
  EXPECT_EQ(hash.hex(), hash_of(1, 2));
}

TEST(ContentHash, OfSeveralOneDependsOnEachAndOnTheirOrder) {
  EXPECT_EQ(combined_hash({hash_of(1)}), hash_of(1));
  EXPECT_NE(combined_hash({hash_of(1), hash_of(2)}), combined_hash({hash_of(2), hash_of(1)}));
  EXPECT_NE(combined_hash({hash_of(1), hash_of(2)}), combined_hash({hash_of(1), hash_of(3)}));
  EXPECT_EQ(combined_hash({hash_of(1), hash_of(2)}), combined_hash({hash_of(1), hash_of(2)}));
}

}  // namespace
}  // namespace screed
