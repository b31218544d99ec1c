// Addresses and registers of the sensors of the AltIMU-10 v4 (LSM303D, L3GD20H, LPS25H) and the
// settings this project uses: ST's data sheets of the three chips, as drivers of other projects
// (Pololu, PX4 and its kin) spell them out.
#pragma once

#include <avr/pgmspace.h>
#include <stdint.h>

#include "pins.h"

namespace screed {
namespace avr {

/// The chips, in the order in which a fault of one is reported.
enum Chip : uint8_t { kAccelMagChip, kGyroChip, kBaroChip, kChips };

constexpr uint8_t kLsm303dAddress = 0x1D;  // SA0 high, as Pololu's boards pull it
constexpr uint8_t kL3gd20hAddress = 0x6B;
constexpr uint8_t kLps25hAddress = 0x5D;

constexpr uint8_t chip_address(Chip chip) {
  return chip == kAccelMagChip ? kLsm303dAddress
         : chip == kGyroChip   ? kL3gd20hAddress
                               : kLps25hAddress;
}

/// Set in a register number: the following bytes belong to the following registers.
constexpr uint8_t kAutoIncrement = 0x80;

constexpr uint8_t kWhoAmI = 0x0F;

// A status register stands right before the data, so one burst says what is new and what it is.
constexpr uint8_t kStatusAndData = 0x27;     // all three: status, then the numbers, low byte first
constexpr uint8_t kMagStatusAndData = 0x07;  // LSM303D
constexpr uint8_t kNewXyz = 1 << 3;          // LSM303D, L3GD20H
constexpr uint8_t kNewPressure = 1 << 1;     // LPS25H

/// What a register must hold. WHO_AM_I is checked like any setting; it cannot be written.
struct Setting {
  Chip chip;
  uint8_t reg;
  uint8_t value;
};

constexpr Setting kSettings[] PROGMEM = {
    {kAccelMagChip, kWhoAmI, 0x49},
    {kAccelMagChip, 0x20, 0x7F},  // CTRL1: 200 Hz, block data update, three axes
    {kAccelMagChip, 0x21, 0xD8},  // CTRL2: anti-alias filter 50 Hz, +-8 g (AFS = 011)
    {kAccelMagChip, 0x24, 0x74},  // CTRL5: magnetometer high resolution, 100 Hz
    {kAccelMagChip, 0x25, 0x20},  // CTRL6: +-4 G
    {kAccelMagChip, 0x26, 0x00},  // CTRL7: magnetometer continuous
    {kGyroChip, kWhoAmI, 0xD7},
    {kGyroChip, 0x39, 0x00},  // LOW_ODR: off
    {kGyroChip, 0x20, 0x7F},  // CTRL1: 200 Hz, cut-off 70 Hz, on, three axes
    {kGyroChip, 0x23, 0xA0},  // CTRL4: block data update, +-2000 dps
    {kBaroChip, kWhoAmI, 0xBD},
    {kBaroChip, 0x20, 0xC4},  // CTRL1: on, 25 Hz, block data update
};
// Those of the barometer, which a board may not have, are the last ones.
constexpr uint8_t kBaroSettings = 2;
constexpr uint8_t kSettingCount =
    sizeof(kSettings) / sizeof(kSettings[0]) - (kHasBarometer ? 0 : kBaroSettings);

}  // namespace avr
}  // namespace screed
