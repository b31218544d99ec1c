// The inertial sensors on the I2C bus, read in the background once a tick.
//
// A round reads gyro, accelerometer and magnetometer (the barometer every 64th round) and one
// configuration register in turn, all in the interrupt of the bus. A register that does not hold
// what it must is written again, and the chip's numbers count as stale until all its registers were
// found right: so a chip is configured at start, and again after a brown-out.
#pragma once

#include "hal/sample.h"

namespace screed {
namespace avr {

void imu_init();

/// Starts a round; called from an interrupt, well before the tick that is to see the numbers.
void imu_start_round();

/// Puts the newest numbers into `sample`, in the robot frame, with their FreshBits; those without
/// news keep their numbers. Frees the bus when the last round hangs. Never waits for a device.
void imu_read(SensorSample& sample);

}  // namespace avr
}  // namespace screed
