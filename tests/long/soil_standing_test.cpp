// A robot that nobody drives stays where it stands on a slope below the ground's friction angle,
// whatever its heading: on tracks and on wheels, on soil and on particles.
// Long: dozens of slopes and headings, on soil and on particles.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "host_sim/physics/soil/soil_bed.h"
#include "tests/sanitizers.h"
#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kMaxCreep_m_per_minute = 0.001;

/// A slope's share of the friction angle, and the robot's heading on it, 0: up.
constexpr std::array<std::pair<double, double>, 4> kCases = {
    {{0.35, 60.0}, {0.7, 0.0}, {0.7, 45.0}, {0.7, 90.0}}};

/// Displacement of a robot in `seconds`, after 5 s to settle, m a minute. `settled_m` receives how
/// far from its start it has come to rest, m.
double creep_m_per_minute(HeightField slope, const WorldOptions& options, double seconds,
                          double* settled_m = nullptr) {
  TestDrive drive(std::move(slope), options);
  drive.run(5.0);
  const Eigen::Vector3d before = drive.position();
  if (settled_m != nullptr) *settled_m = before.head<2>().norm();
  drive.run(seconds);
  return (drive.position() - before).norm() * 60.0 / seconds;
}

// A robot put down level on the steepest slopes: it tips onto its tracks, hits the ground with 0.4
// to 0.8 m/s and slides. As a block of constant friction it would stop within 0.2 m.
TEST(SoilStanding, StopsWhereItFallsOntoItsTracks) {
  for (const double elastic : {4e7, 1e8, 4e8}) {
    for (const double cell_m : {0.01, 0.005}) {
      if (kSanitized && cell_m < 0.01) continue;
      WorldOptions options = drive_options(0.0, 0.0);
      options.soil = soil_preset("lete_sand");
      options.soil->elastic_pa_per_m = elastic;
      TestDrive drive(HeightField::ramp(3.0, cell_m, 0.7 * options.soil->friction_deg), options);
      EXPECT_LT(drive.position().head<2>().norm(), 0.4) << elastic << ", cells " << cell_m;
    }
  }
}

/// A robot laid on a slope that rises to the east, with this heading.
WorldOptions standing_on(double slope_deg, double heading_deg) {
  WorldOptions options = drive_options(0.0, 0.0);
  const double slope = slope_deg * kDeg;
  const double heading = heading_deg * kDeg;
  options.starts[0].attitude.heading = heading;
  options.starts[0].attitude.pitch = std::atan(std::cos(heading) * std::tan(slope));
  options.starts[0].attitude.roll = -std::asin(std::sin(heading) * std::sin(slope));
  return options;
}

// Put down level: it falls onto its tracks.
TEST(SoilStanding, StaysOnSlopesBelowTheFrictionAngle) {
  for (const SoilPreset& preset : soil_presets()) {
    for (const auto& [share, heading_deg] : kCases) {
      if (kSanitized && heading_deg != 45.0) continue;
      WorldOptions options = drive_options(0.0, 0.0);
      options.soil = preset.soil;
      options.starts[0].attitude.heading = heading_deg * kDeg;
      const double slope_deg = share * preset.soil.friction_deg;
      EXPECT_LT(creep_m_per_minute(HeightField::ramp(3.0, 0.01, slope_deg), options, 5.0),
                kMaxCreep_m_per_minute)
          << preset.soil.name << ", slope " << slope_deg << ", heading " << heading_deg;
    }
  }
}

// The dent of a wheel is as long as a cell of 10 mm: wheels need cells of 5 mm.
TEST(SoilStanding, StaysOnItsWheels) {
  for (const SoilPreset& preset : soil_presets()) {
    for (const auto& [share, heading_deg] : kCases) {
      if (kSanitized && heading_deg != 45.0) continue;
      const double slope_deg = share * preset.soil.friction_deg;
      WorldOptions options = standing_on(slope_deg, heading_deg);
      options.vehicle.tracks = false;
      options.soil = preset.soil;
      EXPECT_LT(creep_m_per_minute(HeightField::ramp(2.0, 0.005, slope_deg), options, 5.0),
                kMaxCreep_m_per_minute)
          << preset.soil.name << ", slope " << slope_deg << ", heading " << heading_deg;
    }
  }
}

// `screed soil match`: what a block meets on particles is at least this.
constexpr double kParticleFriction_deg = 21.0;

HeightField particle_slope(double slope_deg) {
  const double rise = std::tan(slope_deg * kDeg);
  return HeightField::from_function(
      11, 11, 0.1, false, [rise](double x, double /*y*/) { return 0.08 + (x + 0.5) * rise; });
}

class StandingOnParticles : public ::testing::TestWithParam<bool> {};

TEST_P(StandingOnParticles, Stays) {
  for (const auto& [share, heading_deg] :
       {std::pair{0.35, 0.0}, {0.35, 90.0}, {0.7, 0.0}, {0.7, 45.0}, {0.7, 90.0}}) {
    if (kSanitized && heading_deg != 45.0) continue;
    const double slope_deg = share * kParticleFriction_deg;
    WorldOptions options = standing_on(slope_deg, heading_deg);
    options.vehicle.tracks = GetParam();
    options.particles.emplace();
    SCOPED_TRACE("slope " + std::to_string(slope_deg) + ", heading " + std::to_string(heading_deg));
    double settled_m = 0.0;
    EXPECT_LT(creep_m_per_minute(particle_slope(slope_deg), options, 10.0, &settled_m),
              kMaxCreep_m_per_minute);
    EXPECT_LT(settled_m, 0.05);  // not held by the wall at the lower end
  }
}

INSTANTIATE_TEST_SUITE_P(Gear, StandingOnParticles, ::testing::Bool(),
                         [](const auto& gear) { return gear.param ? "Tracks" : "Wheels"; });

}  // namespace
}  // namespace screed::testing
