// Two ways to store parameters meet in the EEPROM: a draft on the USB console, and commands by
// radio.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "firmware/parameters/parameter_store.h"
#include "tests/mcu/bench.h"
#include "tests/mcu/usb_host.h"

namespace screed::mcu {
namespace {

std::uint8_t index_of(std::int16_t Parameters::*field) {
  Parameters parameters{};
  parameters.*field = 12345;
  const auto* const values = reinterpret_cast<const std::int16_t*>(&parameters);
  return static_cast<std::uint8_t>(std::find(values, values + kParameterCount, 12345) - values);
}

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
  void draft(std::int16_t Parameters::*field, int value) {
    char line[16];
    std::snprintf(line, sizeof line, "p %02zX %04X", static_cast<std::size_t>(index_of(field)),
                  static_cast<unsigned>(value) & 0xFFFFU);
    EXPECT_EQ(ask(line), std::string(line) + "\n");
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

TEST_F(ParameterEeprom, ARemoteChangeStoresNothingElseOfTheDraft) {
  draft(&Parameters::climb_threshold, 750);
  bench_.set_parameter(index_of(&Parameters::stall_time), 220);
  bench_.run_ms(2500);
  EXPECT_EQ(stored().stall_time, 220);
  EXPECT_EQ(stored().climb_threshold, Parameters{}.climb_threshold);
  // The draft has both, and `w` stores both.
  EXPECT_EQ(ask("w"), "ok\n");
  bench_.run_ms(1000);
  EXPECT_EQ(stored().stall_time, 220);
  EXPECT_EQ(stored().climb_threshold, 750);
}

TEST_F(ParameterEeprom, ARemoteChangeIsStoredWhateverTheDraftSays) {
  draft(&Parameters::climb_threshold, 32000);  // out of its range
  bench_.set_parameter(index_of(&Parameters::stall_time), 220);
  bench_.run_ms(2000);
  EXPECT_EQ(stored().stall_time, 220);
  EXPECT_EQ(stored().climb_threshold, Parameters{}.climb_threshold);
}

TEST_F(ParameterEeprom, ARemoteChangeWaitsForASaveThatIsUnderWay) {
  draft(&Parameters::climb_threshold, 750);
  EXPECT_EQ(ask("w"), "ok\n");
  bench_.set_parameter(index_of(&Parameters::stall_time), 220);
  bench_.run_ms(3500);
  EXPECT_EQ(stored().stall_time, 220);
  EXPECT_EQ(stored().climb_threshold, 750);
}

// Saved for the next start, but at odds with what the robot drives with and changes now.
TEST_F(ParameterEeprom, WhatTheRobotDrivesWithComesBeforeWhatContradictsIt) {
  draft(&Parameters::walk_speed_max, 70);
  EXPECT_EQ(ask("w"), "ok\n");
  bench_.run_ms(2000);
  bench_.set_parameter(index_of(&Parameters::walk_speed_min), 100);
  bench_.run_ms(2000);
  EXPECT_EQ(stored().walk_speed_min, 100);
  EXPECT_EQ(stored().walk_speed_max, Parameters{}.walk_speed_max);
}

}  // namespace
}  // namespace screed::mcu
