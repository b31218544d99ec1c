// CRC-16/CCITT-FALSE, bit by bit: flash is dearer than time.
#include "firmware/math/crc16.h"

#include "firmware/math/fixed.h"

namespace screed {

SCREED_OUT_OF_LINE uint16_t crc16_ccitt(const uint8_t* data, uint8_t size) {
  uint16_t crc = 0xFFFF;
  for (uint8_t i = 0; i < size; ++i) {
    crc = static_cast<uint16_t>(crc ^ static_cast<uint16_t>(static_cast<uint16_t>(data[i]) << 8));
    for (uint8_t bit = 0; bit < 8; ++bit) {
      const bool carry = (crc & 0x8000U) != 0;
      crc = static_cast<uint16_t>(crc << 1);
      if (carry) crc = static_cast<uint16_t>(crc ^ 0x1021U);
    }
  }
  return crc;
}

}  // namespace screed
