// Pololu A-Star 32U4 Robot Controller LV on a Dagu Rover 5: the numbers in which this board differs
// from others.
#pragma once

#include "firmware/parameters/board_constants.h"

namespace screed {

constexpr BoardConstants kBoard = {
    // Wheel radius 30 mm; 1000 state changes in 3 output revolutions (Rover 5 data sheet):
    // 2 pi 30 mm / 333.33 = 565.49 um.
    9048,
    // Sum of eight 10-bit conversions, 5 V reference, 1/3 divider: 5000 mV / 1024 * 3 / 8 =
    // 1875/1024 mV per LSB of the sum.
    1831,
    195,   // track centre to track centre, as in rover5.urdf
    7200,  // motor data sheet
    250,   // Rover 5 data sheet: 25 cm/s
    145,   // 245 x 225 mm over the tracks (data sheet): 123 to 167
};

}  // namespace screed
