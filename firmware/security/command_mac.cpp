// SipHash-2-4 on bytes: gcc for the AVR has no 64-bit numbers worth the name (7 calls into libgcc a
// round), and what is a row of additions with carry is written as that.
#include "firmware/security/command_mac.h"

#include <stddef.h>
#include <string.h>

#include "firmware/math/fixed.h"
#include "firmware/protocol/messages.h"
#include "hal/program_memory.h"

namespace screed {

namespace {

// v0 to v3, eight bytes each, the lowest first.
constexpr uint8_t kWord = 8;
constexpr uint8_t kState = 4 * kWord;

/// "somepseudorandomlygeneratedbytes", each word from its end.
const uint8_t kInitial[kState] SCREED_PROGRAM_MEMORY = {
    'u', 'e', 's', 'p', 'e', 'm', 'o', 's', 'm', 'o', 'd', 'n', 'a', 'r', 'o', 'd',
    'a', 'r', 'e', 'n', 'e', 'g', 'y', 'l', 's', 'e', 't', 'y', 'b', 'd', 'e', 't'};

SCREED_OUT_OF_LINE void exclusive_or(uint8_t* word, const uint8_t* other) {
  for (uint8_t i = 0; i < kWord; ++i) word[i] = static_cast<uint8_t>(word[i] ^ other[i]);
}

/// A quarter of a round: a += b; b = b rotated left by 8 + bits, bits > 0; b ^= a.
#ifdef __AVR__
SCREED_OUT_OF_LINE void mix(uint8_t* a, uint8_t* b, uint8_t bits) {
  uint32_t low;
  uint32_t high;
  uint8_t i;
  uint8_t byte;
  uint8_t* at = a;
  uint8_t* word = b;
  asm volatile(
      // low, high = b, left by eight bits
      "ld %B[low], %a[b]\n\t"
      "ldd %C[low], %a[b]+1\n\t"
      "ldd %D[low], %a[b]+2\n\t"
      "ldd %A[high], %a[b]+3\n\t"
      "ldd %B[high], %a[b]+4\n\t"
      "ldd %C[high], %a[b]+5\n\t"
      "ldd %D[high], %a[b]+6\n\t"
      "ldd %A[low], %a[b]+7\n\t"
      // a += b, byte by byte: dec leaves the carry alone
      "ldi %[i], 8\n\t"
      "clc\n"
      "5:\n\t"
      "ld __tmp_reg__, X\n\t"
      "ld %[byte], %a[b]+\n\t"
      "adc __tmp_reg__, %[byte]\n\t"
      "st X+, __tmp_reg__\n\t"
      "dec %[i]\n\t"
      "brne 5b\n"
      // left by the other bits, one by one
      "1:\n\t"
      "lsl %A[low]\n\t"
      "rol %B[low]\n\t"
      "rol %C[low]\n\t"
      "rol %D[low]\n\t"
      "rol %A[high]\n\t"
      "rol %B[high]\n\t"
      "rol %C[high]\n\t"
      "rol %D[high]\n\t"
      "adc %A[low], __zero_reg__\n\t"
      "dec %[bits]\n\t"
      "brne 1b\n\t"
      // b ^= a, from the end
      "ld __tmp_reg__, -X\n\t"
      "eor %D[high], __tmp_reg__\n\t"
      "st -%a[b], %D[high]\n\t"
      "ld __tmp_reg__, -X\n\t"
      "eor %C[high], __tmp_reg__\n\t"
      "st -%a[b], %C[high]\n\t"
      "ld __tmp_reg__, -X\n\t"
      "eor %B[high], __tmp_reg__\n\t"
      "st -%a[b], %B[high]\n\t"
      "ld __tmp_reg__, -X\n\t"
      "eor %A[high], __tmp_reg__\n\t"
      "st -%a[b], %A[high]\n\t"
      "ld __tmp_reg__, -X\n\t"
      "eor %D[low], __tmp_reg__\n\t"
      "st -%a[b], %D[low]\n\t"
      "ld __tmp_reg__, -X\n\t"
      "eor %C[low], __tmp_reg__\n\t"
      "st -%a[b], %C[low]\n\t"
      "ld __tmp_reg__, -X\n\t"
      "eor %B[low], __tmp_reg__\n\t"
      "st -%a[b], %B[low]\n\t"
      "ld __tmp_reg__, -X\n\t"
      "eor %A[low], __tmp_reg__\n\t"
      "st -%a[b], %A[low]\n\t"
      : [low] "=&r"(low), [high] "=&r"(high), [i] "=&d"(i), [byte] "=&r"(byte), [bits] "+r"(bits),
        [a] "+x"(at), [b] "+b"(word)
      :
      : "memory");
}
#else
void mix(uint8_t* a, uint8_t* b, uint8_t bits) {
  uint64_t sum = 0;
  uint64_t turned = 0;
  for (uint8_t i = kWord; i-- > 0;) {
    sum = sum << 8 | a[i];
    turned = turned << 8 | b[i];
  }
  sum += turned;
  turned = (turned << (8U + bits) | turned >> (56U - bits)) ^ sum;
  for (uint8_t i = 0; i < kWord; ++i) {
    a[i] = static_cast<uint8_t>(sum >> (8U * i));
    b[i] = static_cast<uint8_t>(turned >> (8U * i));
  }
}
#endif

/// Rotation by 32 bits.
SCREED_OUT_OF_LINE void swap_halves(uint8_t* word) {
  for (uint8_t i = 0; i < kWord / 2; ++i) {
    const uint8_t byte = word[i];
    word[i] = word[i + kWord / 2];
    word[i + kWord / 2] = byte;
  }
}

SCREED_OUT_OF_LINE void rounds(uint8_t* v, uint8_t count) {
  uint8_t* const v1 = v + kWord;
  uint8_t* const v2 = v + size_t{2} * kWord;
  uint8_t* const v3 = v + size_t{3} * kWord;
  for (; count > 0; --count) {
    mix(v, v1, 5);  // 13
    swap_halves(v);
    mix(v2, v3, 8);  // 16
    mix(v, v3, 13);  // 21
    mix(v2, v1, 9);  // 17
    swap_halves(v2);
  }
}

}  // namespace

void siphash_2_4(const uint8_t* key, const uint8_t* message, uint8_t size, uint8_t* hash) {
  uint8_t v[kState];
  for (uint8_t i = 0; i < kState; ++i) {
    v[i] = static_cast<uint8_t>(read_program_u8(kInitial + i) ^ key[i % kSipHashKeySize]);
  }
  // The last block ends with the size of the message.
  const uint8_t last = static_cast<uint8_t>(size | (kWord - 1U));
  for (uint8_t at = 0; at <= last;) {
    uint8_t block[kWord];
    for (uint8_t i = 0; i < kWord; ++i, ++at) {
      block[i] = at < size ? message[at] : at == last ? size : static_cast<uint8_t>(0);
    }
    exclusive_or(v + size_t{3} * kWord, block);
    rounds(v, 2);
    exclusive_or(v, block);
  }
  v[size_t{2} * kWord] = static_cast<uint8_t>(v[size_t{2} * kWord] ^ 0xFFU);
  rounds(v, 4);
  for (uint8_t i = 0; i < kWord; ++i) {
    hash[i] = static_cast<uint8_t>(v[i] ^ v[i + kWord] ^ v[i + 2 * kWord] ^ v[i + 3 * kWord]);
  }
}

// What the MAC of a command covers.

void command_mac(const uint8_t* key, uint16_t can_id, uint8_t robot_id, uint16_t boot_epoch,
                 uint16_t counter, const uint8_t* data, uint8_t (&mac)[kSipHashSize]) {
  uint8_t message[7 + kCommandBodySize];
  put_u16(message, can_id);
  message[2] = robot_id;
  put_u16(message + 3, counter);
  put_u16(message + 5, boot_epoch);
  memcpy(message + 7, data, kCommandBodySize);
  siphash_2_4(key, message, sizeof(message), mac);
}

}  // namespace screed
