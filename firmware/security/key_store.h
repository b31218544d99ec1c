// How the key and the number of starts lie in the robot's EEPROM. Pure bytes: the robot's driver
// (hal/avr/credential_eeprom.cpp) and a host that prepares an EEPROM both use this file.
//
//   0x110  16  key
//   0x120  u8  robot id
//   0x121  u16 CRC-16/CCITT-FALSE of the bytes before it; wrong: there is no key
//   0x130  u16 boot epoch of a start with an even one, u16 its complement
//   0x134  the same, of a start with an odd one
//
// Every start writes the slot it did not find the higher number in: power that fails meanwhile
// leaves the other one, and the start whose number was torn has accepted no command yet. 65,535
// starts wear a cell 33,000 times, a third of what it bears; after them no command is accepted any
// more. All numbers are little endian.
#pragma once

#include <stdint.h>

#include "firmware/security/credentials.h"

namespace screed {

constexpr uint16_t kKeyRecordAt = 0x110;
constexpr uint8_t kKeyRecordSize = kSipHashKeySize + 1 + 2;
constexpr uint8_t kEpochSlotSize = 4;
constexpr uint16_t kLastBootEpoch = UINT16_MAX;

/// Address of the slot in which a boot epoch lies.
constexpr uint16_t kEpochSlotAt(uint16_t epoch) {
  return static_cast<uint16_t>(0x130 + (epoch & 1U) * kEpochSlotSize);
}

void encode_key(const Credentials& credentials, uint8_t (&record)[kKeyRecordSize]);
/// Fills key, robot id and key_set.
void decode_key(const uint8_t (&record)[kKeyRecordSize], Credentials& credentials);

void encode_epoch(uint16_t epoch, uint8_t (&slot)[kEpochSlotSize]);
/// 0: nothing valid.
uint16_t decode_epoch(const uint8_t (&slot)[kEpochSlotSize]);

}  // namespace screed
