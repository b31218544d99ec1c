// The motor and battery models against their data sheet points.
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

TEST(Battery, SagsUnderLoadAndEmptiesOverItsCapacity) {
  Battery battery;
  battery.step(0.0, 0.0);
  EXPECT_NEAR(battery.terminal_v, 8.1 - 0.15 * 0.12, 1e-12);
  battery.step(5.0, 0.0);
  EXPECT_NEAR(battery.terminal_v, 8.1 - 0.15 * 5.12, 1e-12);
  // Half of 2 Ah drawn: half-way between full and empty.
  Battery half;
  for (int second = 0; second < 3600; ++second) half.step(1.0 - half.electronics_a, 1.0);
  EXPECT_NEAR(half.drawn_c, 3600.0, 1e-6);
  half.step(-half.electronics_a, 0.0);
  EXPECT_NEAR(half.terminal_v, (8.1 + 6.6) / 2.0, 1e-9);
}

TEST(Battery, EnergyIsVoltageTimesCharge) {
  Battery battery;
  battery.full_v = 7.0;
  battery.empty_v = 7.0;
  battery.resistance_ohm = 0.5;
  battery.electronics_a = 0.0;
  for (int i = 0; i < 1000; ++i) battery.step(2.0, 0.01);
  EXPECT_NEAR(battery.energy_j, (7.0 - 1.0) * 2.0 * 10.0, 1e-9);
}

TEST(Battery, DoesNotGoBelowEmptyNorBelowZero) {
  Battery battery;
  for (int i = 0; i < 10000; ++i) battery.step(2.0, 1.0);
  EXPECT_NEAR(battery.terminal_v, 6.6 - 0.15 * 2.12, 1e-9);
  battery.step(1000.0, 0.001);
  EXPECT_EQ(battery.terminal_v, 0.0);
}

}  // namespace
}  // namespace screed
