// A robot that nobody drives stays where it stands on a slope below the soil's friction angle,
// whatever its heading.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "host_sim/physics/soil/soil_bed.h"
#include "tests/sanitizers.h"
#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

/// How far a disarmed robot goes in `seconds`, after 5 s to settle, m a minute.
double creep_m_per_minute(const char* preset, double slope_deg, double heading_deg,
                          double seconds) {
  WorldOptions options = drive_options(0.0, 0.0);
  options.soil = soil_preset(preset);
  options.start.attitude.heading = heading_deg * kDeg;
  TestDrive drive(HeightField::ramp(3.0, 0.01, slope_deg), options);
  drive.run(5.0);
  const Eigen::Vector3d before = drive.world.vehicle().chassis().pose.translation();
  drive.run(seconds);
  const Eigen::Vector3d after = drive.world.vehicle().chassis().pose.translation();
  return (after - before).norm() * 60.0 / seconds;
}

TEST(SoilStanding, StaysOnSlopesBelowTheFrictionAngle) {
  for (const SoilPreset& preset : soil_presets()) {
    for (const auto& [share, heading_deg] :
         {std::pair{0.35, 60.0}, {0.7, 0.0}, {0.7, 45.0}, {0.7, 90.0}}) {
      if (kSanitized && heading_deg != 45.0) continue;
      const double slope_deg = share * preset.soil.friction_deg;
      const double creep =
          creep_m_per_minute(preset.soil.name.c_str(), slope_deg, heading_deg, 5.0);
      EXPECT_LT(creep, 0.001) << preset.soil.name << ", slope " << slope_deg << ", heading "
                              << heading_deg;
    }
  }
}

}  // namespace
}  // namespace screed::testing
