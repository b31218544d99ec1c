// The stress below a wheel as a lift of its points, against Wong and Reece's formulas written out.
#include "host_sim/physics/soil/wheel_stress.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/physics/soil/passive_pressure.h"

namespace screed {
namespace {

TEST(WheelStressTest, PointsBehindTheGreatestStressBearAsThoseAhead) {
  SoilParameters soil;
  soil.front_angle = 0.3;
  soil.front_angle_driven = 0.2;
  soil.front_angle_braked = 0.4;
  soil.exit_angle = 0.5;
  constexpr double kRadius = 0.05;
  for (const double slip : {-0.5, 0.0, 0.6}) {
    for (const double entry : {0.3, 0.9, 1.4}) {
      const WheelStress stress(soil, kRadius, entry, slip, 1.0);
      const double middle = (0.3 + (slip >= 0.0 ? 0.2 : -0.4) * slip) * entry;
      const double exit = -0.5 * entry;
      ASSERT_TRUE(stress.shaped());
      EXPECT_DOUBLE_EQ(stress.exit_rad(), exit);
      for (double theta = exit; theta <= std::min(entry, 1.5); theta += 0.02) {
        const double lift = stress.lift(std::sin(theta));
        const double ahead = entry - (theta - exit) * (entry - middle) / (middle - exit);
        const double wanted =
            theta >= middle ? 0.0 : kRadius * (std::cos(std::max(theta, 0.0)) - std::cos(ahead));
        EXPECT_NEAR(lift, wanted, 3e-5 * kRadius) << slip << " " << entry << " " << theta;
      }
      // Where it leaves the soil it bears as at its entry: nothing.
      EXPECT_NEAR(stress.lift(std::sin(exit)), kRadius * (1.0 - std::cos(entry)), 3e-5 * kRadius);
    }
  }
}

TEST(WheelStressTest, AWheelThatIsSetDownBearsEvenly) {
  SoilParameters soil;
  soil.front_angle = 0.3;
  EXPECT_FALSE(WheelStress(soil, 0.05, 0.5, 0.0, 0.0).shaped());
  const double sine = 0.05;
  EXPECT_NEAR(WheelStress(soil, 0.05, 0.5, 0.0, 0.5).lift(sine),
              0.5 * WheelStress(soil, 0.05, 0.5, 0.0, 1.0).lift(sine), 1e-12);
}

// At 30 degrees X = 30, cot X = tan(X + phi) = sqrt(3): D1 = D2 = 2 sqrt(3).
TEST(PassivePressureTest, AtThirtyDegreesIsTwelveHalvesOfTheWeight) {
  SoilParameters soil;
  soil.friction_deg = 30.0;
  EXPECT_TRUE(PassivePressure(soil).none());
  soil.density_kg_per_m3 = 1000.0;
  const PassivePressure passive(soil);
  EXPECT_FALSE(passive.none());
  EXPECT_NEAR(passive.resistance(0.1), 0.5 * 12.0 * 1000.0 * 9.80665 * 0.01, 1e-9);
  EXPECT_NEAR(passive.pressure(0.1), 12.0 * 1000.0 * 9.80665 * 0.1, 1e-9);
  soil.cohesion_pa = 100.0;
  EXPECT_NEAR(PassivePressure(soil).resistance(0.1) - passive.resistance(0.1),
              2.0 * std::sqrt(3.0) * 100.0 * 0.1, 1e-9);
}

}  // namespace
}  // namespace screed
