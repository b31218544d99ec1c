// Key and number of starts as bytes of an EEPROM.
#include "firmware/security/key_store.h"

#include <string.h>

#include "firmware/math/crc16.h"
#include "firmware/protocol/bytes.h"

namespace screed {
namespace {

/// 0: nothing valid.
uint16_t get_epoch(const CredentialRecord& record, uint8_t odd) {
  const uint8_t* const slot = record.bytes + epoch_slot_offset(odd);
  const uint16_t epoch = get_u16(slot);
  return get_u16(slot + 2) == static_cast<uint16_t>(~epoch) ? epoch : static_cast<uint16_t>(0);
}

bool is_key(const uint8_t* copy) {
  return get_u16(copy + kKeySize) == crc16_ccitt(copy, kKeySize);
}

}  // namespace

void put_epoch(CredentialRecord& record, uint16_t epoch) {
  uint8_t* const slot = record.bytes + epoch_slot_offset(epoch);
  put_u16(slot, epoch);
  put_u16(slot + 2, static_cast<uint16_t>(~epoch));
}

void put_key(CredentialRecord& record, const uint8_t* key) {
  memcpy(record.bytes, key, kKeySize);
  put_u16(record.bytes + kKeySize, crc16_ccitt(record.bytes, kKeySize));
  memcpy(record.bytes + kSecondKeyOffset, record.bytes, kKeyCopySize);
}

bool begin_start(CredentialRecord& record, Credentials& credentials) {
  const uint8_t* const second = record.bytes + kSecondKeyOffset;
  const uint8_t* const key = is_key(record.bytes) ? record.bytes : second;
  const bool key_set = is_key(key);
  memcpy(credentials.key, key, kKeySize);
  const uint16_t even = get_epoch(record, 0);
  const uint16_t odd = get_epoch(record, 1);
  const uint16_t last = even > odd ? even : odd;
  const bool used_up = last == UINT16_MAX;
  const bool lost = last == 0 && key_set;
  credentials.boot_epoch = used_up ? last : static_cast<uint16_t>(last + 1U);
  credentials.key_set = key_set && !used_up && !lost;
  put_epoch(record, credentials.boot_epoch);
  return !used_up && !lost;
}

}  // namespace screed
