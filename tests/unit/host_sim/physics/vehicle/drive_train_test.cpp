// Motor and battery.
#include <gtest/gtest.h>
#include <numbers>

#include "host_sim/physics/vehicle/drive_train.h"

namespace screed {

namespace {

// The motor against its data sheet.

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

// The battery against the discharge curve of its cells and Ohm's law.

/// Draws a current, the electronics' included.
void draw(Battery& battery, double current_a, int seconds) {
  for (int i = 0; i < seconds; ++i) battery.step(current_a - battery.electronics_a, 1.0);
}

TEST(Battery, SagsUnderLoad) {
  Battery battery;
  battery.step(0.0, 0.0);
  EXPECT_NEAR(battery.terminal_v, 8.4 - 0.15 * 0.12, 1e-12);
  battery.step(5.0, 0.0);
  EXPECT_NEAR(battery.terminal_v, 8.4 - 0.15 * 5.12, 1e-12);
  battery.step(1000.0, 0.001);
  EXPECT_EQ(battery.terminal_v, 0.0);
}

// 2 Ah at 1 A: two hours, on the curve of a discharge in five.
TEST(Battery, EmptiesAlongTheCurveOfItsCells) {
  Battery battery;
  const auto at_rest = [&] {
    Battery rests = battery;
    rests.step(-rests.electronics_a, 0.0);
    return rests.terminal_v;
  };
  draw(battery, 1.0, 3600);
  EXPECT_NEAR(battery.charge(), 0.5, 1e-12);
  EXPECT_NEAR(at_rest(), 6 * 1.25, 1e-9);
  draw(battery, 1.0, 3240);
  EXPECT_NEAR(battery.charge(), 0.05, 1e-9);
  EXPECT_NEAR(at_rest(), 6 * 1.10, 1e-9);
  draw(battery, 1.0, 360);
  EXPECT_NEAR(at_rest(), 6 * 1.0, 1e-9);
  EXPECT_NEAR(*battery.lasts_s(7200.0), 7200.0, 1e-6);
  // No more than 2 Ah comes out of 2 Ah, but for what spoils the cells.
  draw(battery, 1.0, 360);
  EXPECT_NEAR(at_rest(), 0.0, 1e-9);
}

TEST(Battery, BeginsWithWhatItHas) {
  Battery battery;
  battery.begin_with(0.2);
  EXPECT_NEAR(battery.terminal_v, 6 * 1.2, 1e-12);
  EXPECT_FALSE(battery.lasts_s(0.0).has_value());
  draw(battery, 0.5, 720);
  EXPECT_NEAR(battery.charge(), 0.15, 1e-12);
  EXPECT_NEAR(*battery.lasts_s(720.0), 4.0 * 3600.0, 1e-6) << "a full one";
}

// 2 Ah at 2 A: a spare one after 54 minutes, then another.
TEST(Battery, SparesTakeItsPlaceWhenATenthIsLeft) {
  Battery battery;
  battery.spares = 2;
  draw(battery, 2.0, 3239);
  EXPECT_NEAR(battery.charge(), 0.1003, 1e-4);
  draw(battery, 2.0, 3);
  EXPECT_NEAR(battery.charge(), 1.0, 1e-3);
  EXPECT_EQ(battery.spares, 1);
  draw(battery, 2.0, 3242 + 1800);
  EXPECT_EQ(battery.spares, 0);
  EXPECT_NEAR(battery.charge(), 0.5, 1e-2);
  draw(battery, 2.0, 1800);
  EXPECT_NEAR(battery.charge(), 0.0, 1e-2) << "there is none left";
  EXPECT_NEAR(*battery.lasts_s(3239.0 + 3 + 3242 + 3600), 3600.0, 1e-6);
}

TEST(Battery, MuchAtOnceIsAsMuchAsInSteps) {
  Battery at_once;
  at_once.begin_with(0.05);  // spent already
  at_once.spares = 3;
  Battery in_steps = at_once;
  at_once.draw(10000.0);
  for (int i = 0; i < 10000; ++i) in_steps.draw(1.0);
  EXPECT_EQ(at_once.spares, 1);
  EXPECT_EQ(in_steps.spares, 1);
  EXPECT_NEAR(at_once.charge(), in_steps.charge(), 1e-9);
  EXPECT_NEAR(at_once.charge(), 1.0 - (10000.0 - 6480.0) / 7200.0, 1e-9);
}

TEST(Battery, EnergyIsVoltageTimesCharge) {
  Battery battery;
  battery.capacity_c = 1e9;
  battery.resistance_ohm = 0.5;
  battery.begin_with(0.5);
  for (int i = 0; i < 1000; ++i) battery.step(2.0 - battery.electronics_a, 0.01);
  EXPECT_NEAR(battery.energy_j, (7.5 - 1.0) * 2.0 * 10.0, 1e-5);
}

}  // namespace

}  // namespace screed
