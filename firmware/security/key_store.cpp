// Key and boot epoch as bytes of an EEPROM.
#include "firmware/security/key_store.h"

#include <string.h>

#include "firmware/math/crc16.h"
#include "firmware/telemetry/messages.h"

namespace screed {
namespace {

constexpr uint8_t kCrcAt = kKeyRecordSize - 2;

}  // namespace

void encode_key(const Credentials& credentials, uint8_t (&record)[kKeyRecordSize]) {
  memcpy(record, credentials.key, kSipHashKeySize);
  record[kSipHashKeySize] = credentials.robot_id;
  put_u16(record + kCrcAt, crc16_ccitt(record, kCrcAt));
}

void decode_key(const uint8_t (&record)[kKeyRecordSize], Credentials& credentials) {
  memcpy(credentials.key, record, kSipHashKeySize);
  credentials.robot_id = record[kSipHashKeySize];
  credentials.key_set = get_u16(record + kCrcAt) == crc16_ccitt(record, kCrcAt);
}

void encode_epoch(uint16_t epoch, uint8_t (&slot)[kEpochSlotSize]) {
  put_u16(slot, epoch);
  put_u16(slot + 2, static_cast<uint16_t>(~epoch));
}

uint16_t decode_epoch(const uint8_t (&slot)[kEpochSlotSize]) {
  const uint16_t epoch = get_u16(slot);
  return get_u16(slot + 2) == static_cast<uint16_t>(~epoch) ? epoch : static_cast<uint16_t>(0);
}

}  // namespace screed
