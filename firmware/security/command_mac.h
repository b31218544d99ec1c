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

// The message authentication code of a command: SecOC profile 1 (8 bits of freshness and 24 bits of
// MAC travel), over more than travels.
//
//   byte 0   u16  CAN id
//   byte 2   u8   robot id
//   byte 3   u32  freshness: boot epoch << 16 | counter
//   byte 7   4    op and argument, the first four bytes of the frame
//
// The MAC is the first three bytes of SipHash-2-4 over these 11 bytes. Robot and ground station use
// this same code.

constexpr uint8_t kCommandSize = 8;             ///< bytes of a COMMAND frame
constexpr uint8_t kCommandBodySize = 4;         ///< op and argument
constexpr uint8_t kCommandFreshnessOffset = 4;  ///< lower 8 bits of the counter
constexpr uint8_t kCommandMacOffset = 5;
constexpr uint8_t kCommandMacSize = 3;

/// data: at least the first four bytes of the frame. mac: the first kCommandMacSize bytes count.
void command_mac(const uint8_t* key, uint16_t can_id, uint8_t robot_id, uint16_t boot_epoch,
                 uint16_t counter, const uint8_t* data, uint8_t (&mac)[kSipHashSize]);

// What a robot authenticates commands with. Comes from its EEPROM, or from the experiment in a
// simulation; constant while the program runs.

struct Credentials {
  uint8_t key[kSipHashKeySize];
  uint8_t robot_id;     ///< stands behind the key; tells robots with the same key apart
  bool key_set;         ///< false: no key, or a damaged one; no command is accepted
  uint16_t boot_epoch;  ///< number of this start, 1..65535; never the same twice
};

}  // namespace screed
