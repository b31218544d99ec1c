// Pololu Zumo 32U4 with 75:1 HP motors (item 3125 assembled): the numbers in which this board
// differs from others. The version with an LCD and LSM303D + L3GD20H; the later one with an OLED
// carries other sensor chips.
#pragma once

#include "firmware/parameters/board_constants.h"

namespace screed {

constexpr BoardConstants kBoard = {
    // 12 counts a turn of the motor, gear ratio 75.81 (Pololu, "Zumo 2040 User's Guide" 6.4, same
    // motors and encoders): 909.72 counts a turn of the sprocket. Its centre is 19 mm above the
    // ground (Pololu forum, topic 25280): 2 pi 19 mm / 909.72 = 131.23 um.
    2100,
    // Sum of eight 10-bit conversions, 5 V reference, 1/2 divider: 5000 mV / 1024 * 2 / 8 =
    // 625/512 mV per LSB of the sum.
    1221,
    85,    // estimate: 98 mm over all, tracks 13 mm wide
    6000,  // motor data sheet
    796,   // 400 rpm without load at 6 V (motor data sheet) times 119.4 mm
    59,    // 98 x 98 mm over all: 49 to 69
};

}  // namespace screed
