// CRC-16/CCITT-FALSE: polynomial 0x1021, initial value 0xFFFF, not reflected. Of "123456789":
// 0x29B1.
#pragma once

#include <stdint.h>

namespace screed {

uint16_t crc16_ccitt(const uint8_t* data, uint8_t size);

}  // namespace screed
