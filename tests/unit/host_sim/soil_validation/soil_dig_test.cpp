// A slipping belt digs: how much, and where the material goes.
#include <gtest/gtest.h>

#include "host_sim/soil_validation/dig_test.h"

namespace screed {
namespace {

DigResult dig(Manoeuvre manoeuvre, double cell_m, double spin_s = 10.0, bool dragging = true) {
  DigTest test;
  test.manoeuvre = manoeuvre;
  test.soil = soil_preset("gravel");
  if (!dragging) test.soil.drag_depth_m = 0.0;
  test.cell_m = cell_m;
  test.duration_s = manoeuvre == Manoeuvre::kSpin ? spin_s : 10.0;
  return dig_soil(test);
}

// On particles of 15 mm (means of 16 beds, `screed soil dig --ground particles`) 33 cm^3 are raised
// by the spin, to which gravel's drag depth was fitted; 57 at 60 % slip and 15 on the mound. What
// was not fitted is to be within a factor of 1.5; on the mound it is not: less than half is raised
// (docs/measurements/soil.md says so).
TEST(SoilDigTest, MovesAsMuchAsAmongParticles) {
  EXPECT_NEAR(dig(Manoeuvre::kSpin, 0.005).raised_m3, 33e-6, 3e-6);
  const DigResult slip = dig(Manoeuvre::kSlip, 0.005);
  EXPECT_GT(slip.raised_m3, 57e-6 / 1.5);
  EXPECT_LT(slip.raised_m3, 57e-6 * 1.5);
  EXPECT_NEAR(slip.time_s, 0.57 / 0.08, 0.1);  // at 60 % slip indeed
  const DigResult charge = dig(Manoeuvre::kCharge, 0.005);
  EXPECT_GT(charge.raised_m3, 15e-6 / 2.25);
  EXPECT_LT(charge.raised_m3, 15e-6 * 1.5);
  EXPECT_GT(charge.distance_m, 0.5);  // it comes over the mound
}

TEST(SoilDigTest, WithoutDraggingASpinOnlySinks) {
  EXPECT_LT(dig(Manoeuvre::kSpin, 0.005, 3.0, false).raised_m3, 3e-6);
}

// What a spin digs from below the belts lies around the ring that they swept.
TEST(SoilDigTest, TheGridDoesNotMatter) {
  const DigResult coarse = dig(Manoeuvre::kSpin, 0.01, 4.0);
  const DigResult fine = dig(Manoeuvre::kSpin, 0.005, 4.0);
  EXPECT_NEAR(coarse.raised_m3, fine.raised_m3, 0.25 * fine.raised_m3);
  EXPECT_NEAR(coarse.deepest_m, fine.deepest_m, 0.2 * fine.deepest_m);
  EXPECT_GT(fine.raised_radius_m, fine.sunk_radius_m);
}

}  // namespace
}  // namespace screed
