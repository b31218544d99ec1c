// The inertial sensors on the I2C bus, read in the background once a tick.
#include "hal/avr/imu.h"

#include <avr/pgmspace.h>
#include <stdint.h>
#include <string.h>

#include "hal/avr/interrupts_off.h"
#include "hal/avr/twi.h"
#include "pins.h"

namespace screed {

// Addresses and registers of the sensors of the AltIMU-10 v4 (LSM303D, L3GD20H, LPS25H) and the
// settings this project uses: ST's data sheets of the three chips, as drivers of other projects
// (Pololu, PX4 and its kin) spell them out.

namespace avr {

/// The chips, by the bit that reports a fault of one.
enum Chip : uint8_t {
  kAccelMagChip = ChipBit::kAccelMagChip,
  kGyroChip = ChipBit::kGyroChip,
  kBaroChip = ChipBit::kBaroChip,
};
constexpr uint8_t kChipEnd = kBaroChip + 1;
constexpr uint8_t kAllChips = kAccelMagChip | kGyroChip | (kHasBarometer ? kBaroChip : 0);

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

namespace avr {
namespace {

/// The transfers of a round, in their order.
enum Step : uint8_t { kReadGyro, kReadAccel, kReadMag, kReadBaro, kCheckSetting, kRewriteSetting };

constexpr uint8_t kVectorBytes = 7;  // status and three axes
constexpr uint8_t kBaroBytes = 6;    // status, pressure (3), temperature (2)

/// What a step up to kReadBaro reads; as the first members of TwiTransfer.
struct Burst {
  uint8_t address;
  uint8_t reg;
  uint8_t size;
  uint8_t tag;  ///< its FreshBit; in the upper half the ChipBit that fails when it does not come
};
constexpr Burst burst_of(Chip chip, uint8_t reg, uint8_t size, FreshBit fresh, uint8_t fails) {
  return {chip_address(chip), static_cast<uint8_t>(reg | kAutoIncrement), size,
          static_cast<uint8_t>(fails << 4 | fresh)};
}
constexpr Burst kBursts[] PROGMEM = {
    burst_of(kGyroChip, kStatusAndData, kVectorBytes, kFreshGyro, kGyroChip),
    burst_of(kAccelMagChip, kStatusAndData, kVectorBytes, kFreshAccel, kAccelMagChip),
    burst_of(kAccelMagChip, kMagStatusAndData, kVectorBytes, kFreshMag, 0),
    burst_of(kBaroChip, kStatusAndData, kBaroBytes, kFreshBaro, kBaroChip),
};
constexpr uint8_t kBurstCount = sizeof(kBursts) / sizeof(kBursts[0]);
static_assert(kBurstCount == kReadBaro + 1, "a row each");
// The barometer is only reported, once a second: read every 0.64 s.
constexpr uint8_t kBaroRounds = 64;

/// Who owns the state: the bus interrupt from the start of a round to its end, the main program
/// while it reads.
enum Phase : uint8_t { kIdle, kRunning, kBusStuck, kReading };

struct State {
  volatile Phase phase;
  Step step;
  uint8_t round;
  uint8_t arrived;  // FreshBit set of the bursts that came whole in this round
  uint8_t bursts[kBurstCount][kVectorBytes];
  // The check of settings.
  uint8_t setting;                     // number of the one checked in this round
  Setting checked;                     // that one
  uint8_t register_value;              // what was read, then what is to be written
  uint8_t consecutive_good[kChipEnd];  // settings of a chip found right since the last wrong one
  uint8_t unconfigured;                // ChipBit set: not all settings were found right
  uint8_t failing;                     // ChipBit set: the last burst did not come
  uint8_t errors;                      // transfers that failed
};
State state;

constexpr uint8_t settings_of(Chip chip, uint8_t from = 0) {
  return from == kSettingCount
             ? static_cast<uint8_t>(0)
             : static_cast<uint8_t>((kSettings[from].chip == chip ? 1 : 0) +
                                    settings_of(chip, static_cast<uint8_t>(from + 1)));
}

/// How many settings a chip has.
constexpr uint8_t kSettingsOf[kChipEnd] PROGMEM = {
    0, settings_of(kAccelMagChip), settings_of(kGyroChip), 0, settings_of(kBaroChip)};

/// Prepares the transfer of this step.
void set_transfer() {
  if (state.step <= kReadBaro) {
    memcpy_P(&twi_transfer, &kBursts[state.step], sizeof(Burst));
    twi_transfer.data = state.bursts[state.step];
  } else {
    memcpy_P(&state.checked, &kSettings[state.setting], sizeof(Setting));
    twi_transfer.address = chip_address(state.checked.chip);
    twi_transfer.reg = state.checked.reg;
    twi_transfer.size = 1;
    twi_transfer.tag = 0;
    twi_transfer.data = &state.register_value;
  }
  twi_transfer.write = state.step == kRewriteSetting;
}

/// Books what the check of a setting found; returns true when the register has to be written.
bool judge_setting(bool ok) {
  const uint8_t chip = state.checked.chip;
  uint8_t& right = state.consecutive_good[chip];
  if (ok && state.register_value == state.checked.value) {
    if (right < kSettingCount) ++right;
    if (right >= pgm_read_byte(&kSettingsOf[chip])) {
      state.unconfigured = static_cast<uint8_t>(state.unconfigured & ~chip);
    }
    return false;
  }
  right = 0;
  state.unconfigured = static_cast<uint8_t>(state.unconfigured | chip);
  state.register_value = state.checked.value;
  return ok && state.checked.reg != kWhoAmI;
}

/// The step after `state.step`; false when the round is over.
bool next_step(bool ok) {
  switch (state.step) {
    case kReadMag:
      state.step = kHasBarometer && state.round % kBaroRounds == 0 ? kReadBaro : kCheckSetting;
      return true;
    case kCheckSetting:
      if (judge_setting(ok)) {
        state.step = kRewriteSetting;
        return true;
      }
      break;
    case kRewriteSetting:
      break;
    default:
      state.step = static_cast<Step>(state.step + 1);
      return true;
  }
  state.setting = static_cast<uint8_t>(state.setting + 1 == kSettingCount ? 0 : state.setting + 1);
  return false;
}

int16_t word_at(const uint8_t* bytes) {
  return static_cast<int16_t>(bytes[0] |
                              static_cast<uint16_t>(static_cast<uint16_t>(bytes[1]) << 8));
}

/// The sensors lie in the robot with their axes along its own, as on both boards so far.
constexpr bool lie_along_robot(uint8_t from = 0) {
  return from == 3 || (kImuAxes[from].index == from && !kImuAxes[from].reversed &&
                       lie_along_robot(static_cast<uint8_t>(from + 1)));
}
constexpr bool kLieAlongRobot = lie_along_robot();

/// From the chip's axes to the robot's. An axis against the chip's turns -32768 into 32767.
void to_robot_frame(const uint8_t* bytes, int16_t* vector) {
  if (kLieAlongRobot) {
    memcpy(vector, bytes, 3 * sizeof(*vector));
    return;
  }
  for (uint8_t i = 0; i < 3; ++i) {
    const ChipAxis axis = kImuAxes[i];
    const int16_t value = word_at(bytes + 2 * axis.index);
    vector[i] = !axis.reversed       ? value
                : value == INT16_MIN ? static_cast<int16_t>(INT16_MAX)
                                     : static_cast<int16_t>(-value);
  }
}

/// Gyro, accelerometer and magnetometer, in the order of their bursts and of ImuCounts.
void take_vectors(SensorSample& sample) {
  Chip chip = kGyroChip;
  uint8_t bit = kFreshGyro;
  int16_t* vector = sample.imu.all;
  for (const uint8_t* burst = state.bursts[kReadGyro]; bit <= kFreshMag; burst += kVectorBytes) {
    if ((state.arrived & bit) != 0 && (burst[0] & kNewXyz) != 0 &&
        (state.unconfigured & chip) == 0) {
      to_robot_frame(burst + 1, vector);
      sample.fresh = static_cast<uint8_t>(sample.fresh | bit);
    }
    chip = kAccelMagChip;
    bit = static_cast<uint8_t>(bit << 1);
    vector += 3;
  }
}

void take_baro(SensorSample& sample) {
  const uint8_t* const burst = state.bursts[kReadBaro];
  if ((state.arrived & kFreshBaro) == 0 || (burst[0] & kNewPressure) == 0 ||
      (state.unconfigured & kBaroChip) != 0) {
    return;
  }
  sample.pressure = static_cast<int32_t>(word_at(burst + 2)) * 256 | burst[1];
  sample.temperature = word_at(burst + 4);
  sample.fresh = static_cast<uint8_t>(sample.fresh | kFreshBaro);
}

}  // namespace

bool twi_done(bool ok) {
  const uint8_t tag = twi_transfer.tag;
  const uint8_t chip = tag / 16U;  // a shift would be one of 16 bits
  if (ok) {
    state.arrived = static_cast<uint8_t>(state.arrived | tag);
    state.failing = static_cast<uint8_t>(state.failing & ~chip);
  } else {
    state.errors = static_cast<uint8_t>(state.errors + 1);
    state.failing = static_cast<uint8_t>(state.failing | chip);
  }
  if (!next_step(ok)) {
    state.phase = kIdle;
    return false;
  }
  set_transfer();
  return true;
}

void imu_init() {
  state.unconfigured = kAllChips;
  // A reset may have come in the middle of a byte: the device still holds the bus.
  twi_recover();
}

__attribute__((noinline)) void imu_start_round() {
  if (state.phase == kRunning) state.phase = kBusStuck;  // for 10 ms, when 1.3 ms is enough
  if (state.phase != kIdle) return;
  state.phase = kRunning;
  state.step = kReadGyro;
  state.arrived = 0;
  state.round = static_cast<uint8_t>(state.round + 1);
  set_transfer();
  twi_start();
}

void imu_read(SensorSample& sample) {
  sample.fresh = 0;
  Phase phase = kIdle;
  {
    const InterruptsOff interrupts_off;
    phase = state.phase;
    if (phase != kRunning) state.phase = kReading;
  }
  if (phase == kRunning) return;  // the tick is late; the numbers come with the next one
  if (phase == kBusStuck) {
    twi_recover();
    state.arrived = 0;
    state.failing = kAllChips;
    state.errors = static_cast<uint8_t>(state.errors + 1);
  }
  take_vectors(sample);
  take_baro(sample);
  sample.chips_failing = static_cast<uint8_t>(state.failing | state.unconfigured);
  sample.bus_errors = state.errors;
  state.arrived = 0;
  {
    const InterruptsOff interrupts_off;
    state.phase = kIdle;
  }
}

}  // namespace avr

}  // namespace screed
