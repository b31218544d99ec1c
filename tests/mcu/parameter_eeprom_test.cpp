// Two ways to store parameters meet in the EEPROM: the defaults by the USB console, and commands by
// radio.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "firmware/parameters/parameter_store.h"
#include "tests/mcu/bench.h"
#include "tests/mcu/usb_host.h"

namespace screed::mcu {
namespace {

class ParameterEeprom : public ::testing::Test {
 protected:
  ParameterEeprom() : usb_(bench_.mcu) {
    bench_.ground_station = true;
    bench_.run_ms(500);
    EXPECT_TRUE(usb_.plug_in());
    EXPECT_TRUE(usb_.set_line(115200, true));
  }
  std::string ask(const std::string& line) {
    usb_.send(line + "\n");
    return usb_.listen_ms(60);
  }
  /// By radio.
  void change(Parameters::Number number, std::int16_t value) {
    bench_.set_parameter(number, value);
    bench_.run_ms(2500);
  }
  /// Of the newest copy.
  Parameters stored() const {
    const std::vector<std::uint8_t> eeprom = bench_.mcu.read_eeprom();
    ParameterCopy copies[kParameterCopies];
    for (std::uint8_t i = 0; i < kParameterCopies; ++i) {
      std::copy_n(eeprom.begin() + parameter_copy_address(i), kParameterCopySize, copies[i].bytes);
    }
    const StoreChoice choice = choose_copy(check_copy(copies[0]), copy_sequence(copies[0]),
                                           check_copy(copies[1]), copy_sequence(copies[1]));
    EXPECT_EQ(choice.state, StoreState::kStored);
    Parameters parameters{};
    decode_parameters(copies[choice.copy], parameters);
    return parameters;
  }

  Bench bench_;
  UsbHost usb_;
};

TEST_F(ParameterEeprom, TheDefaultsComeBackForTheNextStart) {
  change(Parameters::k_climb_threshold, 750);
  EXPECT_EQ(stored().climb_threshold(), 750);
  EXPECT_EQ(ask("d"), "ok\n");
  bench_.run_ms(1000);
  EXPECT_EQ(stored().climb_threshold(), Parameters{}.climb_threshold());
}

TEST_F(ParameterEeprom, ARemoteChangeWaitsForASaveThatIsUnderWay) {
  change(Parameters::k_climb_threshold, 750);
  EXPECT_EQ(ask("d"), "ok\n");
  EXPECT_EQ(ask("d"), "?\n") << "one at a time";
  bench_.set_parameter(Parameters::k_stall_time, 220);
  bench_.run_ms(3500);
  EXPECT_EQ(stored().stall_time(), 220);
  EXPECT_EQ(stored().climb_threshold(), Parameters{}.climb_threshold());
}

// The defaults are saved for the next start, but at odds with what the robot drives with and
// changes now.
TEST_F(ParameterEeprom, WhatTheRobotDrivesWithComesBeforeWhatContradictsIt) {
  change(Parameters::k_walk_speed_max, 240);
  change(Parameters::k_walk_speed_min, 200);
  EXPECT_EQ(ask("d"), "ok\n");
  bench_.run_ms(2000);
  EXPECT_EQ(stored().walk_speed_max(), Parameters{}.walk_speed_max());
  change(Parameters::k_walk_speed_min, 210);
  EXPECT_EQ(stored().walk_speed_min(), 210);
  EXPECT_EQ(stored().walk_speed_max(), 240);
}

}  // namespace
}  // namespace screed::mcu
