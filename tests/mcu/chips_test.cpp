// The chips' registers and the bus they are on, touched by hand: what the data sheets say.
#include <gtest/gtest.h>

#include <fstream>

#include "host_sim/core/errors.h"
#include "host_sim/devices/mcu/imu_chips.h"
#include "host_sim/devices/mcu/wiring.h"
#include "tests/mcu/images.h"

namespace screed::mcu {
namespace {

class Chips : public ::testing::Test {
 protected:
  Chips() : mcu_(kGoldenImage), bus_(mcu_), accel_mag_(bus_), gyro_(bus_), baro_(bus_) {}

  static void write(I2cChip& chip, std::uint8_t address, std::uint8_t number, std::uint8_t value) {
    ASSERT_TRUE(chip.select(address, false));
    ASSERT_TRUE(chip.write(number));
    ASSERT_TRUE(chip.write(value));
    chip.stop();
  }
  static std::vector<int> read(I2cChip& chip, std::uint8_t address, std::uint8_t number,
                               int count) {
    EXPECT_TRUE(chip.select(address, false));
    EXPECT_TRUE(chip.write(number));
    EXPECT_TRUE(chip.select(address, true));
    std::vector<int> bytes(static_cast<std::size_t>(count));
    for (int& byte : bytes) byte = chip.read();
    chip.stop();
    return bytes;
  }
  static int word(const std::vector<int>& bytes, std::size_t at) {
    return static_cast<std::int16_t>(bytes.at(at) | bytes.at(at + 1) << 8);
  }

  Mcu mcu_;
  TwiBus bus_;
  Lsm303d accel_mag_;
  L3gd20h gyro_;
  Lps25h baro_;
};

constexpr std::uint8_t kAuto = 0x80;

TEST_F(Chips, SayWhoTheyAreAndAnswerOnlyToTheirAddress) {
  EXPECT_EQ(read(accel_mag_, 0x1D, 0x0F, 1).at(0), 0x49);
  EXPECT_EQ(read(gyro_, 0x6B, 0x0F, 1).at(0), 0xD7);
  EXPECT_EQ(read(baro_, 0x5D, 0x0F, 1).at(0), 0xBD);
  EXPECT_FALSE(gyro_.select(0x1D, false));
  gyro_.present = false;
  EXPECT_FALSE(gyro_.select(0x6B, false));
}

TEST_F(Chips, MeasureAtTheConfiguredRates) {
  EXPECT_EQ(accel_mag_.accel_rate_hz(), 0.0) << "power-down after power-up";
  EXPECT_EQ(accel_mag_.mag_rate_hz(), 0.0);
  EXPECT_EQ(gyro_.rate_hz(), 0.0);
  EXPECT_EQ(baro_.rate_hz(), 0.0);
  write(accel_mag_, 0x1D, 0x20, 0x7F);
  EXPECT_EQ(accel_mag_.accel_rate_hz(), 200.0);
  write(accel_mag_, 0x1D, 0x20, 0x17);
  EXPECT_EQ(accel_mag_.accel_rate_hz(), 3.125);
  write(accel_mag_, 0x1D, 0x26, 0x00);
  write(accel_mag_, 0x1D, 0x24, 0x74);
  EXPECT_EQ(accel_mag_.mag_rate_hz(), 100.0);
  write(gyro_, 0x6B, 0x20, 0x7F);
  EXPECT_EQ(gyro_.rate_hz(), 189.4);
  write(gyro_, 0x6B, 0x39, 0x01);
  EXPECT_EQ(gyro_.rate_hz(), 25.0);
  write(baro_, 0x5D, 0x20, 0xC4);
  EXPECT_EQ(baro_.rate_hz(), 25.0);
}

TEST_F(Chips, CountInTheConfiguredFullScale) {
  accel_mag_.measure_accel({1000.0, -500.0, 250.0});
  EXPECT_EQ(word(read(accel_mag_, 0x1D, 0x28 | kAuto, 6), 0), 16393);  // 0.061 mg, +-2 g
  write(accel_mag_, 0x1D, 0x21, 0xD8);
  accel_mag_.measure_accel({1000.0, -500.0, 250.0});
  const std::vector<int> accel = read(accel_mag_, 0x1D, 0x28 | kAuto, 6);
  EXPECT_EQ(word(accel, 0), 4098);  // 0.244 mg: AFS = 011 is +-8 g
  EXPECT_EQ(word(accel, 2), -2049);
  accel_mag_.measure_accel({1e6, -1e6, 0.0});
  const std::vector<int> most = read(accel_mag_, 0x1D, 0x28 | kAuto, 6);
  EXPECT_EQ(word(most, 0), 32767);
  EXPECT_EQ(word(most, 2), -32768);
  write(gyro_, 0x6B, 0x23, 0xA0);
  gyro_.measure({70.0, -7.0, 0.0});
  EXPECT_EQ(word(read(gyro_, 0x6B, 0x28 | kAuto, 6), 0), 1000);
  baro_.measure(1013.25, 20.0);
  const std::vector<int> baro = read(baro_, 0x5D, 0x28 | kAuto, 5);
  EXPECT_EQ(baro[0] | baro[1] << 8 | baro[2] << 16, 4150272);
  EXPECT_EQ(word(baro, 3), -10800);
}

TEST_F(Chips, StatusTellsNewAndOverrunAndForgetsWhatWasRead) {
  EXPECT_EQ(read(gyro_, 0x6B, 0x27, 1).at(0), 0x00);
  gyro_.measure({1.0, 2.0, 3.0});
  EXPECT_EQ(read(gyro_, 0x6B, 0x27, 1).at(0), 0x0F);
  gyro_.measure({1.0, 2.0, 3.0});
  EXPECT_EQ(read(gyro_, 0x6B, 0x27, 1).at(0), 0xFF);
  read(gyro_, 0x6B, 0x28 | kAuto, 6);
  EXPECT_EQ(read(gyro_, 0x6B, 0x27, 1).at(0), 0x00);
}

TEST_F(Chips, BlockDataUpdateKeepsTheTwoBytesOfAValueTogether) {
  for (const bool block : {false, true}) {
    write(gyro_, 0x6B, 0x23, block ? 0xA0 : 0x20);
    gyro_.measure({255 * 0.070, 0.0, 0.0});  // 0x00FF
    const int low = read(gyro_, 0x6B, 0x28, 1).at(0);
    gyro_.measure({256 * 0.070, 0.0, 0.0});  // 0x0100
    const int high = read(gyro_, 0x6B, 0x29, 1).at(0);
    EXPECT_EQ(low | high << 8, block ? 0x00FF : 0x01FF);
  }
}

TEST_F(Chips, WithoutAutoIncrementARegisterRepeats) {
  gyro_.measure({255 * 0.00875, 0.0, 0.0});
  EXPECT_EQ(read(gyro_, 0x6B, 0x28, 3), (std::vector<int>{0xFF, 0xFF, 0xFF}));
}

TEST_F(Chips, ForgetTheirSettingsInABrownOut) {
  write(gyro_, 0x6B, 0x20, 0x7F);
  gyro_.power_up();
  EXPECT_EQ(read(gyro_, 0x6B, 0x20, 1).at(0), 0x07);
  EXPECT_EQ(gyro_.rate_hz(), 0.0);
}

TEST_F(Chips, NameEveryRegisterThatIsNotTheirs) {
  read(gyro_, 0x6B, 0x2F, 1);
  ASSERT_TRUE(gyro_.failure().has_value());
  EXPECT_EQ(*gyro_.failure(),
            "L3GD20H: the program reads register 0x2F, which the model does not declare");
  write(baro_, 0x5D, 0x0F, 0x01);
  ASSERT_TRUE(baro_.failure().has_value());
  EXPECT_EQ(*baro_.failure(),
            "LPS25H: the program writes register 0x0F (value 0x01), which is read-only");
}

TEST(WiringFile, SaysWhatIsWrongAndWhere) {
  const std::string good = [] {
    std::ifstream file(kWiring);
    return std::string(std::istreambuf_iterator<char>(file), {});
  }();
  EXPECT_NO_THROW(read_wiring(kWiring));
  struct Case {
    const char* from;
    const char* to;
    const char* says;
  };
  for (const Case& it : {Case{"left_pwm = PB5", "left_pwm = PC6", "PB5 (OC1A) or PB6 (OC1B)"},
                         Case{"left_a = PB4", "left_a = PZ9", "a pin as PB5"},
                         Case{"wiring = plain", "wiring = star", "plain or xored"},
                         Case{"red = PB0 low", "red = PB0", "the level that lights the LED"},
                         Case{"divider = 3", "divider = 0", "a number 1..20"},
                         Case{"axes = x y z", "axes = x y x", "x, y and z in some order"},
                         Case{"axes = x y z", "", "[imu] axes is missing"},
                         Case{"axes = x y z", "axis = x y z", "unknown key 'axis' in [imu]"}}) {
    std::string text = good;
    const std::size_t at = text.find(it.from);
    ASSERT_NE(at, std::string::npos) << it.from;
    text.replace(at, std::string(it.from).size(), it.to);
    const std::string path = ::testing::TempDir() + "screed_wiring_test.ini";
    std::ofstream(path) << text;
    try {
      read_wiring(path);
      ADD_FAILURE() << it.to << " is taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(it.says), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find(path), 0U) << error.what();
    }
  }
}

}  // namespace
}  // namespace screed::mcu
