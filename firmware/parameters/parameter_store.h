// How the parameters lie in the robot's EEPROM: two copies, each with a sequence number and a CRC,
// so that a write that power cuts short leaves the other copy. Pure bytes: the robot's driver
// (hal/avr/eeprom.cpp) and a host that prepares an EEPROM both use this file.
//
//   byte 0   u16  layout     kParameterLayout: the table these numbers belong to
//   byte 2   u16  sequence   the copy with the higher one (modulo 2^16) is the newer
//   byte 4   s16  values     one a parameter, in the order of the table in parameters.h
//   last 2   u16  crc        CRC-16/CCITT-FALSE of all bytes before it
//
// All numbers are little endian. Copy 0 begins at parameter_copy_address(0), copy 1 at
// parameter_copy_address(1). A store in which every byte of both copies is 0xFF was never written:
// the defaults hold.
#pragma once

#include <stdint.h>

#include "firmware/parameters/parameters.h"

namespace screed {

constexpr uint8_t kParameterCopies = 2;
constexpr uint8_t kParameterHeaderSize = 4;
constexpr uint8_t kParameterCopySize = kParameterHeaderSize + 2 * Parameters::kCount + 2;

/// Address of the first byte of a copy. The first 16 bytes of the EEPROM stay free, and each copy
/// has room to grow.
constexpr uint16_t parameter_copy_address(uint8_t copy) {
  return static_cast<uint16_t>(0x10 + 0x80 * copy);
}
static_assert(kParameterCopySize <= 0x80, "a copy has 128 bytes");

namespace detail {

constexpr uint16_t layout_hash(const char* text, uint16_t hash) {
  return *text == 0 ? static_cast<uint16_t>(hash * 31U + 7U)
                    : layout_hash(text + 1,
                                  static_cast<uint16_t>(hash * 31U + static_cast<uint8_t>(*text)));
}

}  // namespace detail

/// Made of all names and units in their order: numbers of another table are not taken for ours.
constexpr uint16_t kParameterLayout =
#define SCREED_HASH(name, unit, min, max, value, meaning) detail::layout_hash(#name "," unit ";",
    SCREED_PARAMETERS(SCREED_HASH)
#undef SCREED_HASH
        1
#define SCREED_HASH(name, unit, min, max, value, meaning) )
    SCREED_PARAMETERS(SCREED_HASH)
#undef SCREED_HASH
    ;

/// One copy as it lies in the EEPROM.
struct ParameterCopy {
  uint8_t bytes[kParameterCopySize];
};

enum class CopyState : uint8_t {
  kGood,   ///< right layout and CRC
  kBlank,  ///< 0xFF throughout
  kBad,    ///< anything else
};

/// Where the parameters of a start come from.
enum class StoreState : uint8_t {
  kStored,   ///< a good copy
  kBlank,    ///< never written: the defaults
  kCorrupt,  ///< no good copy: the defaults, and the robot must not be armed
};

/// Puts the sequence number into a copy whose values stand, and what tells a good copy.
void seal_copy(uint16_t sequence, ParameterCopy& copy);
void encode_parameters(const Parameters& parameters, uint16_t sequence, ParameterCopy& copy);

CopyState check_copy(const ParameterCopy& copy);

/// Values and sequence number of a good copy.
void decode_parameters(const ParameterCopy& copy, Parameters& parameters);
uint16_t copy_sequence(const ParameterCopy& copy);

/// Which copy to read (0, 1), when there is one.
struct StoreChoice {
  StoreState state;
  uint8_t copy;       ///< the one to read; meaningful in kStored
  uint8_t next_copy;  ///< the one to write next: never the only good one
  uint16_t next_sequence;
};
StoreChoice choose_copy(CopyState state0, uint16_t sequence0, CopyState state1, uint16_t sequence1);

}  // namespace screed
