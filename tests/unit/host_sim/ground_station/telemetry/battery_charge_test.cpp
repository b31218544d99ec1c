// How full a NiMH battery is.
#include "host_sim/ground_station/telemetry/battery_charge.h"

#include <gtest/gtest.h>

namespace screed {
namespace {

TEST(BatteryCharge, FollowsTheCurveOfACell) {
  EXPECT_EQ(battery_charge(6 * 1.45, 6), 1.0);
  EXPECT_EQ(battery_charge(6 * 0.95, 6), 0.0);
  EXPECT_NEAR(battery_charge(4 * 1.25, 4).value_or(-1.0), 0.5, 1e-9);
  EXPECT_NEAR(battery_charge(6 * 1.225, 6).value_or(-1.0), 0.35, 1e-9);
  double before = -1.0;
  for (double volts = 5.0; volts < 9.0; volts += 0.01) {
    const double charge = battery_charge(volts, 6).value_or(-1.0);
    EXPECT_GE(charge, before) << volts;
    EXPECT_LE(charge, 1.0);
    before = charge;
  }
}

TEST(BatteryCharge, OfWhatIsNoSuchBatteryIsNotGuessed) {
  EXPECT_FALSE(battery_charge(7.2, 0).has_value());
  EXPECT_FALSE(battery_charge(0.0, 6).has_value());
  EXPECT_FALSE(battery_charge(11.1, 6).has_value());
  EXPECT_FALSE(battery_charge(5.0, 2).has_value());
}

TEST(BatteryCharge, IsSaidInStepsOfFivePerCent) {
  EXPECT_EQ(battery_text(8.1, 6), "8.10 V, 95 %");
  EXPECT_EQ(battery_text(7.104, 6), "7.10 V, 15 %");
  EXPECT_EQ(battery_text(7.2, 0), "7.20 V");
}

}  // namespace
}  // namespace screed
