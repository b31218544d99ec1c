// AUTOSAR E2E Profile 2.
#include "firmware/protocol/e2e.h"

#include "firmware/math/fixed.h"

namespace screed {

namespace {

constexpr uint8_t kPolynomial = 0x2F;

#ifdef __AVR__
// Bit by bit: a table would take more flash than is left.
uint8_t after_eight_bits(uint8_t crc) {
  for (uint8_t bit = 0; bit < 8; ++bit) {
    const bool carry = (crc & 0x80U) != 0;
    crc = static_cast<uint8_t>(crc << 1);
    if (carry) crc = static_cast<uint8_t>(crc ^ kPolynomial);
  }
  return crc;
}
#else
/// Of each byte: bit by bit, simulated worlds would spend a twentieth of their time on CRCs.
struct CrcTable {
  uint8_t after[256];
  constexpr CrcTable() : after() {
    for (unsigned i = 0; i < 256; ++i) {
      unsigned crc = i;
      for (int bit = 0; bit < 8; ++bit) crc = crc << 1 ^ ((crc & 0x80U) != 0 ? kPolynomial : 0U);
      after[i] = static_cast<uint8_t>(crc);
    }
  }
};
constexpr CrcTable kTable;

uint8_t after_eight_bits(uint8_t crc) {
  return kTable.after[crc];
}
#endif

}  // namespace

uint8_t crc8_h2f(uint8_t crc, const uint8_t* data, uint8_t size) {
  for (uint8_t i = 0; i < size; ++i) crc = after_eight_bits(static_cast<uint8_t>(crc ^ data[i]));
  return crc;
}

SCREED_OUT_OF_LINE uint8_t e2e_crc(uint8_t data_id, const uint8_t* data, uint8_t size) {
  const uint8_t over_data = crc8_h2f(0xFF, data + 1, static_cast<uint8_t>(size - 1));
  return static_cast<uint8_t>(crc8_h2f(over_data, &data_id, 1) ^ 0xFFU);
}

void e2e_protect(uint16_t can_id, uint8_t counter, uint8_t* data, uint8_t size) {
  data[1] = static_cast<uint8_t>((data[1] & 0xF0U) | (counter & 0x0FU));
  data[0] = e2e_crc(e2e_data_id(can_id), data, size);
}

bool e2e_check(uint16_t can_id, const uint8_t* data, uint8_t size) {
  if (size < 3 || size > 8) return false;
  return data[0] == e2e_crc(e2e_data_id(can_id), data, size);
}

}  // namespace screed
