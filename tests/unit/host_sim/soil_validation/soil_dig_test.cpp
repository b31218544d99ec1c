// A slipping belt digs: how much, and where the material goes.
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host_sim/core/errors.h"
#include "host_sim/soil_validation/dig_test.h"

namespace screed {
namespace {

DigResult dig(Manoeuvre manoeuvre, double cell_m, double spin_s = 10.0, bool dragging = true) {
  DigTest test;
  test.manoeuvre = manoeuvre;
  test.soil = soil_preset("gravel");
  if (!dragging) test.soil.slip_layer_m = test.lug_height_m = 0.0;
  test.cell_m = cell_m;
  test.duration_s = manoeuvre == Manoeuvre::kSpin ? spin_s : 10.0;
  return dig_soil(test);
}

/// What particles of 15 mm move, cm^3: `screed soil dig --ground particles --beds 64`, the volume
/// without noise at least and that of the mean (docs/studies/soil.md, Digging).
struct OnParticles {
  double raised_at_least;
  double raised;
  double sunk_at_least;
  double sunk;
};
constexpr OnParticles kSpin = {25.8, 28.2, 87.8, 90.2};
constexpr OnParticles kSlip = {52.3, 54.7, 125.2, 127.6};
constexpr OnParticles kCharge = {8.8, 10.1, 31.0, 32.2};  // of 160 beds

// Within the factor of both ends of the measurement.
void expect_raised(double factor, const OnParticles& particles, const DigResult& soil) {
  EXPECT_GT(soil.raised_m3 * 1e6, particles.raised / factor);
  EXPECT_LT(soil.raised_m3 * 1e6, particles.raised_at_least * factor);
}
void expect_sunk(double factor, const OnParticles& particles, const DigResult& soil) {
  EXPECT_GT(soil.sunk_m3 * 1e6, particles.sunk / factor);
  EXPECT_LT(soil.sunk_m3 * 1e6, particles.sunk_at_least * factor);
}

// Gravel's slip layer and compaction were fitted to the spin. The other two are to be within a
// factor of 1.5. On the mound soil moves too little (docs/studies/soil.md says so and why): no
// less than it does.
TEST(SoilDigTest, MovesAsMuchAsAmongParticles) {
  const DigResult spin = dig(Manoeuvre::kSpin, 0.005);
  expect_raised(1.1, kSpin, spin);
  expect_sunk(1.1, kSpin, spin);
  const DigResult slip = dig(Manoeuvre::kSlip, 0.005);
  expect_raised(1.5, kSlip, slip);
  expect_sunk(1.5, kSlip, slip);
  EXPECT_NEAR(slip.time_s, 0.57 / 0.08, 0.1);  // at 60 % slip indeed
  const DigResult charge = dig(Manoeuvre::kCharge, 0.005);
  // Known to be missed; one that is met again fails here, and is to be asserted as it stands.
  EXPECT_NONFATAL_FAILURE(expect_raised(1.6, kCharge, charge), "raised_m3");
  EXPECT_NONFATAL_FAILURE(expect_sunk(1.5, kCharge, charge), "sunk_m3");
  expect_raised(2.9, kCharge, charge);
  expect_sunk(2.5, kCharge, charge);
  EXPECT_LT(charge.deepest_m, 0.0012);  // nowhere deeper than particles
  EXPECT_GT(charge.distance_m, 0.5);    // it comes over the mound
}

// Volume times the way along the slip. Gravel's drag share was fitted to the 60 % slip; strokes on
// level ground and at 5 degrees, to which nothing was fitted, are within a factor of 2.3 of
// particles, 8 to 16 beds (docs/studies/soil.md, Strokes).
TEST(SoilDigTest, SlipCarriesAsFarAsAmongParticles) {
  EXPECT_NEAR(dig(Manoeuvre::kSlip, 0.005).carried_m4 * 1e6, -8.5, 0.3);
  struct OnSlope {
    double slope_deg;
    double carried_cm3m;
  };
  for (const OnSlope& particles : {OnSlope{0.0, 2.2}, OnSlope{5.0, -6.1}}) {
    DigTest test;
    test.manoeuvre = Manoeuvre::kStrokes;
    test.soil = soil_preset("gravel");
    test.slope_deg = particles.slope_deg;
    const double carried = dig_soil(test).carried_m4 * 1e6;
    EXPECT_GT(carried / particles.carried_cm3m, 1.0 / 2.3) << particles.slope_deg;
    EXPECT_LT(carried / particles.carried_cm3m, 2.3) << particles.slope_deg;
  }
}

// On four beds of particles a spin of 40 s sinks 127 cm3 more than it raises, twice as much as one
// of 10 s: ground is trodden down once. compaction_depth was fitted to that; sunk are 250 cm3
// (docs/studies/soil.md).
TEST(SoilDigTest, ALongSpinFindsGroundThatIsDense) {
  const DigResult spin = dig(Manoeuvre::kSpin, 0.005, 40.0);
  EXPECT_NEAR((spin.sunk_m3 - spin.raised_m3) * 1e6, 127.0, 10.0);
  EXPECT_NEAR(spin.sunk_m3 * 1e6, 250.0, 25.0);
}

// On 16 beds of particles 10 s of spin carry 2.9 +- 0.25 and 4.8 +- 0.28 cm3 m down slopes of 10
// and 15 degrees. Nothing was fitted to that.
TEST(SoilDigTest, ASpinOnASlopeCarriesMaterialDownhill) {
  DigTest test;
  test.soil = soil_preset("gravel");
  test.slope_deg = 10.0;
  EXPECT_NEAR(dig_soil(test).downhill_m4 * 1e6, 2.92, 2 * 0.25);
  test.slope_deg = 15.0;
  EXPECT_NEAR(dig_soil(test).downhill_m4 * 1e6, 4.75, 2 * 0.28);
  test.manoeuvre = Manoeuvre::kCharge;
  EXPECT_THROW(dig_soil(test), InputError);
}

TEST(SoilDigTest, WithoutDraggingASpinOnlySinks) {
  EXPECT_LT(dig(Manoeuvre::kSpin, 0.005, 3.0, false).raised_m3, 3e-6);
}

/// Raised volume north (1) or south (-1) of the robot's line, m^3.
double raised_beside(const DigResult& result, double side) {
  const HeightField& before = result.before;
  double raised = 0.0;
  for (int iy = 0; iy < before.ny(); ++iy) {
    if (before.node_y(iy) * side <= 0.0) continue;
    for (int ix = 0; ix < before.nx(); ++ix)
      raised += std::max(0, result.after.node(ix, iy) - before.node(ix, iy)) * kHeightUnit_m;
  }
  return raised * before.spacing_m() * before.spacing_m();
}

// Each belt compacts its share of what it sinks, and deposits the rest.
TEST(SoilDigTest, BothBeltsRaiseTheSame) {
  const DigResult slip = dig(Manoeuvre::kSlip, 0.005, 0.0, false);
  const double north = raised_beside(slip, 1.0);
  EXPECT_GT(north, 0.5e-6);
  EXPECT_NEAR(north, raised_beside(slip, -1.0), 0.05 * north);
}

// What a spin digs from below the belts lies around the ring that they swept.
TEST(SoilDigTest, TheGridDoesNotMatter) {
  const DigResult coarse = dig(Manoeuvre::kSpin, 0.01, 4.0);
  const DigResult fine = dig(Manoeuvre::kSpin, 0.005, 4.0);
  EXPECT_NEAR(coarse.raised_m3, fine.raised_m3, 0.25 * fine.raised_m3);
  EXPECT_NEAR(coarse.deepest_m, fine.deepest_m, 0.2 * fine.deepest_m);
  EXPECT_GT(fine.raised_radius_m, fine.sunk_radius_m);
}

// ---- Volumes told from noisy maps whose true volumes are known

constexpr double kArea_m2 = 2.5e-5;
constexpr size_t kNodes = 1000;
constexpr double kTrueRaised_m3 = 100 * 1e-3 * kArea_m2;
constexpr double kTrueSunk_m3 = 200 * 2e-3 * kArea_m2;

/// 100 nodes rise by 1 mm, 200 sink by 2 mm, the others stay; each map has noise of 2 mm.
std::vector<RiseMap> noisy_maps(size_t count, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, 2e-3);
  std::vector<RiseMap> maps(count, RiseMap(kNodes));
  for (RiseMap& map : maps) {
    for (size_t node = 0; node < kNodes; ++node)
      map[node] = (node < 100 ? 1e-3 : node < 300 ? -2e-3 : 0.0) + noise(random);
  }
  return maps;
}

TEST(MovedVolumeTest, TheTrueVolumeLiesBetweenTheTwoEstimates) {
  std::mt19937_64 random(1);
  const std::vector<RiseMap> maps = noisy_maps(64, random);
  MovedVolume last = volume_of_means(maps, kArea_m2, 1);
  for (const size_t beds : {4U, 16U, 64U}) {
    const MovedVolume now = volume_of_means(maps, kArea_m2, beds);
    EXPECT_LT(now.raised_m3, 0.8 * last.raised_m3);
    EXPECT_LT(now.sunk_m3, 0.9 * last.sunk_m3);
    last = now;
  }
  // 700 nodes of noise of 0.25 mm count for 0.1 mm each (s / sqrt(2 pi)), up and down.
  const double noise_m3 = 700 * 0.25e-3 / std::sqrt(2.0 * M_PI) * kArea_m2;
  EXPECT_NEAR(last.raised_m3, kTrueRaised_m3 + noise_m3, 0.1 * noise_m3);
  EXPECT_NEAR(last.sunk_m3, kTrueSunk_m3 + noise_m3, 0.1 * noise_m3);
  const MovedVolume least = volume_without_noise(maps, kArea_m2);
  EXPECT_NEAR(least.raised_m3, kTrueRaised_m3, 0.1 * kTrueRaised_m3);
  EXPECT_NEAR(least.sunk_m3, kTrueSunk_m3, 0.02 * kTrueSunk_m3);
}

// Two others have noise of 1.41 mm: 0.760 of the 1 mm up are taken as up, 0.921 of the 2 mm down as
// down. What is taken wrongly counts against either.
TEST(MovedVolumeTest, FewMapsGiveLessThanTheTruth) {
  std::mt19937_64 random(2);
  MovedVolume mean;
  constexpr int kSets = 200;
  for (int i = 0; i < kSets; ++i) {
    const MovedVolume least = volume_without_noise(noisy_maps(3, random), kArea_m2);
    mean.raised_m3 += least.raised_m3 / kSets;
    mean.sunk_m3 += least.sunk_m3 / kSets;
  }
  EXPECT_NEAR(mean.raised_m3, 0.760 * kTrueRaised_m3 - 0.079 * kTrueSunk_m3, 0.05 * kTrueRaised_m3);
  EXPECT_NEAR(mean.sunk_m3, 0.921 * kTrueSunk_m3 - 0.240 * kTrueRaised_m3, 0.02 * kTrueSunk_m3);
}

TEST(MovedVolumeTest, TheStandardErrorIsTheSpreadOfRepetitions) {
  std::mt19937_64 random(3);
  constexpr int kSets = 200;
  double sum = 0.0;
  double squares = 0.0;
  double error = 0.0;
  for (int i = 0; i < kSets; ++i) {
    const std::vector<RiseMap> maps = noisy_maps(16, random);
    const double raised = volume_of_means(maps, kArea_m2, 16).raised_m3;
    sum += raised;
    squares += raised * raised;
    error += standard_error(maps, kArea_m2).raised_m3 / kSets;
  }
  const double spread = std::sqrt((squares - sum * sum / kSets) / (kSets - 1));
  EXPECT_NEAR(error, spread, 0.2 * spread);
}

TEST(MovedVolumeTest, OneMapTellsNothingOfItsNoise) {
  std::mt19937_64 random(4);
  const std::vector<RiseMap> one = noisy_maps(1, random);
  EXPECT_GT(volume_of_means(one, kArea_m2, 1).raised_m3, 0.0);
  EXPECT_EQ(volume_of_means(one, kArea_m2, 2).raised_m3, 0.0);
  EXPECT_EQ(volume_without_noise(one, kArea_m2).raised_m3, 0.0);
  EXPECT_EQ(standard_error(one, kArea_m2).sunk_m3, 0.0);
}

}  // namespace
}  // namespace screed
