// The motor against its data sheet.
#include "host_sim/physics/vehicle/gear_motor.h"

#include <gtest/gtest.h>

#include <numbers>

namespace screed {
namespace {

TEST(GearMotor, MeetsTheDataSheet) {
  const GearMotor motor;
  // Stall: 2.5 A and 10 kg cm at 7.2 V.
  EXPECT_NEAR(motor.current(7.2, 0.0), 2.5, 1e-9);
  EXPECT_NEAR(motor.torque_per_ampere() * 2.5, 10.0 * 0.0980665, 0.01);
  // No load: 25 cm/s on wheels of 30 mm, where the current only covers friction.
  const double omega = 0.25 / 0.030;
  EXPECT_NEAR(motor.torque_per_ampere() * motor.current(7.2, omega), motor.friction_torque(),
              0.006);
}

TEST(GearMotor, IsSymmetricAndBrakesAsAGenerator) {
  const GearMotor motor;
  EXPECT_DOUBLE_EQ(motor.current(-7.2, -3.0), -motor.current(7.2, 3.0));
  EXPECT_LT(motor.current(0.0, 5.0), 0.0);
  EXPECT_LT(motor.efficiency, 1.0);
}

}  // namespace
}  // namespace screed
