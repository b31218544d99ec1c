// Parameters as bytes of an EEPROM.
#include "firmware/parameters/parameter_store.h"

#include <string.h>

#include "firmware/math/crc16.h"
#include "firmware/protocol/messages.h"

namespace screed {
namespace {

constexpr uint8_t kCrcAt = kParameterCopySize - 2;

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are copied as they are");

uint16_t crc_of(const ParameterCopy& copy) {
  return crc16_ccitt(copy.bytes, kCrcAt);
}

}  // namespace

void seal_copy(uint16_t sequence, ParameterCopy& copy) {
  put_u16(copy.bytes, kParameterLayout);
  put_u16(copy.bytes + 2, sequence);
  put_u16(copy.bytes + kCrcAt, crc_of(copy));
}

void encode_parameters(const Parameters& parameters, uint16_t sequence, ParameterCopy& copy) {
  memcpy(copy.bytes + kParameterHeaderSize, parameters.values, sizeof(parameters.values));
  seal_copy(sequence, copy);
}

CopyState check_copy(const ParameterCopy& copy) {
  if (get_u16(copy.bytes) == kParameterLayout && get_u16(copy.bytes + kCrcAt) == crc_of(copy)) {
    return CopyState::kGood;
  }
  for (const uint8_t byte : copy.bytes) {
    if (byte != 0xFF) return CopyState::kBad;
  }
  return CopyState::kBlank;
}

void decode_parameters(const ParameterCopy& copy, Parameters& parameters) {
  memcpy(parameters.values, copy.bytes + kParameterHeaderSize, sizeof(parameters.values));
}

uint16_t copy_sequence(const ParameterCopy& copy) {
  return get_u16(copy.bytes + 2);
}

StoreChoice choose_copy(CopyState state0, uint16_t sequence0, CopyState state1,
                        uint16_t sequence1) {
  const bool good0 = state0 == CopyState::kGood;
  const bool good1 = state1 == CopyState::kGood;
  if (!good0 && !good1) {
    const bool blank = state0 == CopyState::kBlank && state1 == CopyState::kBlank;
    return {blank ? StoreState::kBlank : StoreState::kCorrupt, 0, 0, 0};
  }
  const bool newer1 =
      good1 && (!good0 || static_cast<int16_t>(static_cast<uint16_t>(sequence1 - sequence0)) > 0);
  return {StoreState::kStored, static_cast<uint8_t>(newer1 ? 1 : 0),
          static_cast<uint8_t>(newer1 ? 0 : 1),
          static_cast<uint16_t>((newer1 ? sequence1 : sequence0) + 1U)};
}

}  // namespace screed
