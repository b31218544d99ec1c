// SipHash-2-4, the keyed hash that authenticates commands: two rounds a block of eight bytes, four
// at the end, 64 bits out.
//
// Source: Aumasson, Bernstein, "SipHash: a fast short-input PRF", 2012, whose test vectors the
// tests hold.
#pragma once

#include <stdint.h>

namespace screed {

constexpr uint8_t kSipHashKeySize = 16;
constexpr uint8_t kSipHashSize = 8;

/// Hash of message[0..size) under a key of 16 bytes, in the byte order of the published vectors.
void siphash_2_4(const uint8_t* key, const uint8_t* message, uint8_t size, uint8_t* hash);

}  // namespace screed
