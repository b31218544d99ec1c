// How the key and the number of starts lie in the robot's EEPROM. Pure bytes: the robot's driver
// (hal/avr/eeprom.cpp) and a host that prepares an EEPROM both use this file.
//
//   byte 0   16   key
//   byte 16  u8   robot id
//   byte 17  u16  CRC-16/CCITT-FALSE of the bytes before it
//   byte 19  u16  number of the last start with an even one, u16 its complement
//   byte 23  u16  number of the last start with an odd one, u16 its complement
//   byte 27  19   key, robot id and CRC once more
//
// The bytes are written in their order, so power that fails meanwhile leaves the new key in the
// first copy or the old one in the second. With both CRCs wrong there is no key.
// Every start writes its number over that of two starts before: power that fails meanwhile leaves
// the other one, and the start whose number was torn has accepted no command yet. 65,535 starts
// wear a cell 33,000 times, a third of its endurance; after them no command is accepted any more.
// Nor is one when both numbers are damaged, until a key is set anew: old commands would be fresh
// again. All numbers are little endian.
#pragma once

#include <stdint.h>

#include "firmware/security/command_mac.h"

namespace screed {

constexpr uint8_t kKeySize = kSipHashKeySize + 1;  ///< key and robot id
constexpr uint8_t kEpochSlotSize = 4;
constexpr uint8_t kKeyCopySize = kKeySize + 2;
constexpr uint8_t kSecondKeyOffset = kKeyCopySize + 2 * kEpochSlotSize;
constexpr uint8_t kCredentialRecordSize = kSecondKeyOffset + kKeyCopySize;
/// Address of its first byte, behind the parameters.
constexpr uint16_t kCredentialRecordAddress = 0x110;

struct CredentialRecord {
  uint8_t bytes[kCredentialRecordSize];
};

/// Place of the number of a start in the record.
constexpr uint8_t epoch_slot_offset(uint16_t epoch) {
  return static_cast<uint8_t>(kKeySize + 2U + (epoch & 1U) * kEpochSlotSize);
}

/// Begins a start: reads the record and puts the number of this start into it. True: the slot of
/// that number has to be written before a command may be accepted.
bool begin_start(CredentialRecord& record, Credentials& credentials);

/// Puts the number of a start into its slot.
void put_epoch(CredentialRecord& record, uint16_t epoch);

/// Puts key and robot id, kKeySize bytes, into the record of a start that has begun. All of it has
/// to be written.
void put_key(CredentialRecord& record, const uint8_t* key);

}  // namespace screed
