// A sensor on the I2C bus as registers.
#include "host_sim/devices/mcu/imu_chips.h"

#include <cmath>
#include <cstdio>

#include "host_sim/devices/sensors/imu_model.h"

namespace screed::mcu {
namespace {

constexpr std::uint8_t kAutoIncrement = 0x80;
constexpr std::uint8_t kNumber = 0x7F;

}  // namespace

I2cChip::I2cChip(TwiBus& bus, std::string name, std::uint8_t address)
    : name_(std::move(name)), address_(address) {
  bus.attach(*this);
}

void I2cChip::declare(std::uint8_t number, Access access, std::uint8_t after_power_up) {
  access_.at(number) = access;
  defaults_.at(number) = registers_.at(number) = after_power_up;
}

void I2cChip::power_up() {
  registers_ = defaults_;
  pointer_ = 0;
  pointer_set_ = false;
  was_powered();
}

bool I2cChip::select(std::uint8_t address, bool read) {
  if (!present || address != address_) return false;
  if (!read) pointer_set_ = false;
  return true;
}

void I2cChip::advance() {
  if ((pointer_ & kAutoIncrement) == 0) return;
  pointer_ = static_cast<std::uint8_t>(kAutoIncrement | ((pointer_ + 1) & kNumber));
}

void I2cChip::fail(const char* what, std::uint8_t number, std::optional<std::uint8_t> value) {
  if (failure_.has_value()) return;
  char text[64];
  if (value.has_value()) {
    std::snprintf(text, sizeof text, "0x%02X (value 0x%02X)", number, *value);
  } else {
    std::snprintf(text, sizeof text, "0x%02X", number);
  }
  failure_ = name_ + ": the program " + what + " register " + text +
             (access_.at(number) == Access::kReadOnly ? ", which is read-only"
                                                      : ", which the model does not declare");
}

bool I2cChip::write(std::uint8_t byte) {
  if (!present) return false;
  if (!pointer_set_) {
    pointer_ = byte;
    pointer_set_ = true;
    return true;
  }
  const std::uint8_t number = pointer_ & kNumber;
  if (access_.at(number) != Access::kReadWrite) fail("writes", number, byte);
  registers_.at(number) = byte;
  written.push_back(number);
  was_written(number);
  advance();
  return true;
}

std::uint8_t I2cChip::read() {
  if (!present) return 0xFF;
  const std::uint8_t number = pointer_ & kNumber;
  if (access_.at(number) == Access::kNone) fail("reads", number, std::nullopt);
  ++reads;
  const std::uint8_t value = registers_.at(number);
  was_read(number);
  advance();
  return value;
}

// The three chips of the AltIMU-10 v4.

namespace {

constexpr std::uint8_t kWhoAmI = 0x0F;
constexpr std::uint8_t kCtrl1 = 0x20;
constexpr std::uint8_t kStatus = 0x27;
constexpr std::uint8_t kOut = 0x28;
// LSM303D
constexpr std::uint8_t kMagStatus = 0x07;
constexpr std::uint8_t kMagOut = 0x08;
constexpr std::uint8_t kCtrl2 = 0x21;
constexpr std::uint8_t kCtrl5 = 0x24;
constexpr std::uint8_t kCtrl6 = 0x25;
constexpr std::uint8_t kCtrl7 = 0x26;
// L3GD20H
constexpr std::uint8_t kCtrl4 = 0x23;
constexpr std::uint8_t kLowOdr = 0x39;
// LPS25H
constexpr std::uint8_t kTemperature = 0x2B;
constexpr std::uint8_t kTemperatureNew = 1 << 0;
constexpr std::uint8_t kPressureNew = 1 << 1;
constexpr std::uint8_t kTemperatureOverrun = 1 << 4;
constexpr std::uint8_t kPressureOverrun = 1 << 5;

constexpr std::uint8_t kAllNew = 1 << 3;
constexpr std::uint8_t kAllOverrun = 1 << 7;

void declare_vector(auto&& declare, std::uint8_t status, std::uint8_t first) {
  declare(status, Access::kReadOnly, std::uint8_t{0});
  for (std::uint8_t i = 0; i < 6; ++i) {
    declare(static_cast<std::uint8_t>(first + i), Access::kReadOnly, std::uint8_t{0});
  }
}

std::array<std::int16_t, 3> counts_of(const Eigen::Vector3d& value, double lsb) {
  return {ImuModel::quantise(value.x(), lsb), ImuModel::quantise(value.y(), lsb),
          ImuModel::quantise(value.z(), lsb)};
}

}  // namespace

template <class Set>
void VectorOutput::put(const std::array<std::int16_t, 3>& counts, bool block_data_update,
                       Set&& at) {
  std::uint8_t& status = at(status_);
  for (std::uint8_t axis = 0; axis < 3; ++axis) {
    const auto bit = static_cast<std::uint8_t>(1U << axis);
    if ((status & bit) != 0) status = static_cast<std::uint8_t>(status | bit << 4);
    // A value whose low byte has been read keeps its high byte until that is read as well.
    if (block_data_update && reading_.at(axis)) continue;
    const auto value = static_cast<std::uint16_t>(counts.at(axis));
    at(static_cast<std::uint8_t>(first_ + 2 * axis)) = static_cast<std::uint8_t>(value & 0xFF);
    at(static_cast<std::uint8_t>(first_ + 2 * axis + 1)) = static_cast<std::uint8_t>(value >> 8);
    status = static_cast<std::uint8_t>(status | bit);
  }
  if ((status & kAllNew) != 0) status = static_cast<std::uint8_t>(status | kAllOverrun);
  status = static_cast<std::uint8_t>(status | kAllNew);
}

template <class Set>
void VectorOutput::was_read(std::uint8_t number, Set&& at) {
  if (number < first_ || number >= first_ + 6) return;
  const auto axis = static_cast<std::uint8_t>((number - first_) / 2);
  const bool high = (number - first_) % 2 != 0;
  reading_.at(axis) = !high;
  if (!high) return;
  std::uint8_t& status = at(status_);
  status = static_cast<std::uint8_t>(status & ~(0x11U << axis));
  if ((status & 0x07U) == 0) status = 0;
}

// ---- LSM303D

Lsm303d::Lsm303d(TwiBus& bus, std::uint8_t address)
    : I2cChip(bus, "LSM303D", address), accel_(kStatus, kOut), mag_(kMagStatus, kMagOut) {
  const auto add = [this](std::uint8_t number, Access access, std::uint8_t value) {
    declare(number, access, value);
  };
  add(kWhoAmI, Access::kReadOnly, 0x49);
  add(kCtrl1, Access::kReadWrite, 0x07);
  add(kCtrl2, Access::kReadWrite, 0x00);
  add(kCtrl5, Access::kReadWrite, 0x18);
  add(kCtrl6, Access::kReadWrite, 0x20);
  add(kCtrl7, Access::kReadWrite, 0x01);
  declare_vector(add, kStatus, kOut);
  declare_vector(add, kMagStatus, kMagOut);
}

double Lsm303d::accel_rate_hz() const {
  const unsigned code = register_value(kCtrl1) >> 4;
  return code == 0 || code > 10 ? 0.0 : std::ldexp(3.125, static_cast<int>(code) - 1);
}

double Lsm303d::mag_rate_hz() const {
  if ((register_value(kCtrl7) & 3U) != 0) return 0.0;
  const unsigned code = register_value(kCtrl5) >> 2 & 7U;
  return code > 5 ? 0.0 : std::ldexp(3.125, static_cast<int>(code));
}

void Lsm303d::measure_accel(const Eigen::Vector3d& mg) {
  static constexpr std::array<double, 8> kLsb_mg = {0.061, 0.122, 0.183, 0.244,
                                                    0.732, 0.732, 0.732, 0.732};
  const double lsb = kLsb_mg.at(register_value(kCtrl2) >> 3 & 7U);
  const bool block = (register_value(kCtrl1) & 1U << 3) != 0;
  accel_.put(counts_of(mg, lsb), block, [this](std::uint8_t n) -> std::uint8_t& { return at(n); });
}

void Lsm303d::measure_mag(const Eigen::Vector3d& mgauss) {
  static constexpr std::array<double, 4> kLsb_mgauss = {0.080, 0.160, 0.320, 0.479};
  const double lsb = kLsb_mgauss.at(register_value(kCtrl6) >> 5 & 3U);
  const bool block = (register_value(kCtrl1) & 1U << 3) != 0;
  mag_.put(counts_of(mgauss, lsb), block,
           [this](std::uint8_t n) -> std::uint8_t& { return at(n); });
}

void Lsm303d::was_read(std::uint8_t number) {
  const auto set = [this](std::uint8_t n) -> std::uint8_t& { return at(n); };
  accel_.was_read(number, set);
  mag_.was_read(number, set);
}

void Lsm303d::was_powered() {
  accel_.clear();
  mag_.clear();
}

// ---- L3GD20H

L3gd20h::L3gd20h(TwiBus& bus, std::uint8_t address)
    : I2cChip(bus, "L3GD20H", address), gyro_(kStatus, kOut) {
  const auto add = [this](std::uint8_t number, Access access, std::uint8_t value) {
    declare(number, access, value);
  };
  add(kWhoAmI, Access::kReadOnly, 0xD7);
  add(kCtrl1, Access::kReadWrite, 0x07);
  add(kCtrl4, Access::kReadWrite, 0x00);
  add(kLowOdr, Access::kReadWrite, 0x00);
  declare_vector(add, kStatus, kOut);
}

double L3gd20h::rate_hz() const {
  const std::uint8_t control = register_value(kCtrl1);
  if ((control & 1U << 3) == 0 || (control & 7U) == 0) return 0.0;  // power-down, sleep
  static constexpr std::array<double, 4> kLow = {12.5, 25.0, 50.0, 50.0};
  static constexpr std::array<double, 4> kHigh = {94.7, 189.4, 378.8, 757.6};
  return ((register_value(kLowOdr) & 1U) != 0 ? kLow : kHigh).at(control >> 6);
}

void L3gd20h::measure(const Eigen::Vector3d& dps) {
  static constexpr std::array<double, 4> kLsb_dps = {0.00875, 0.0175, 0.070, 0.070};
  const std::uint8_t control = register_value(kCtrl4);
  gyro_.put(counts_of(dps, kLsb_dps.at(control >> 4 & 3U)), (control & 0x80U) != 0,
            [this](std::uint8_t n) -> std::uint8_t& { return at(n); });
}

void L3gd20h::was_read(std::uint8_t number) {
  gyro_.was_read(number, [this](std::uint8_t n) -> std::uint8_t& { return at(n); });
}

void L3gd20h::was_powered() {
  gyro_.clear();
}

// ---- LPS25H

Lps25h::Lps25h(TwiBus& bus, std::uint8_t address) : I2cChip(bus, "LPS25H", address) {
  declare(kWhoAmI, Access::kReadOnly, 0xBD);
  declare(kCtrl1, Access::kReadWrite, 0x00);
  declare(kStatus, Access::kReadOnly);
  for (std::uint8_t i = 0; i < 5; ++i) {
    declare(static_cast<std::uint8_t>(kOut + i), Access::kReadOnly);
  }
}

double Lps25h::rate_hz() const {
  const std::uint8_t control = register_value(kCtrl1);
  if ((control & 0x80U) == 0) return 0.0;
  static constexpr std::array<double, 8> kRate = {0.0, 1.0, 7.0, 12.5, 25.0, 0.0, 0.0, 0.0};
  return kRate.at(control >> 4 & 7U);
}

void Lps25h::measure(double pressure_hpa, double temperature_degc) {
  const bool block = (register_value(kCtrl1) & 1U << 2) != 0;
  std::uint8_t& status = at(kStatus);
  if ((status & kPressureNew) != 0) status = static_cast<std::uint8_t>(status | kPressureOverrun);
  if ((status & kTemperatureNew) != 0)
    status = static_cast<std::uint8_t>(status | kTemperatureOverrun);
  if (!block || !reading_pressure_) {
    const auto raw = static_cast<std::uint32_t>(std::lround(pressure_hpa * 4096.0));
    for (unsigned i = 0; i < 3; ++i) {
      at(static_cast<std::uint8_t>(kOut + i)) = static_cast<std::uint8_t>(raw >> (8 * i) & 0xFF);
    }
    status = static_cast<std::uint8_t>(status | kPressureNew);
  }
  if (!block || !reading_temperature_) {
    const auto raw =
        static_cast<std::uint16_t>(ImuModel::quantise(temperature_degc - 42.5, 1.0 / 480.0));
    at(kTemperature) = static_cast<std::uint8_t>(raw & 0xFF);
    at(kTemperature + 1) = static_cast<std::uint8_t>(raw >> 8);
    status = static_cast<std::uint8_t>(status | kTemperatureNew);
  }
}

void Lps25h::was_read(std::uint8_t number) {
  std::uint8_t& status = at(kStatus);
  switch (number) {
    case kOut:
      reading_pressure_ = true;
      break;
    case kOut + 2:
      reading_pressure_ = false;
      status = static_cast<std::uint8_t>(status & ~(kPressureNew | kPressureOverrun));
      break;
    case kTemperature:
      reading_temperature_ = true;
      break;
    case kTemperature + 1:
      reading_temperature_ = false;
      status = static_cast<std::uint8_t>(status & ~(kTemperatureNew | kTemperatureOverrun));
      break;
    default:
      break;
  }
}

}  // namespace screed::mcu
