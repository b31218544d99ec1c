// A wheel on soil, or on a bed of particles, in a single-wheel testbed: its travel and spin are
// imposed, and it is free up and down.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host_sim/physics/particles/sphere_law.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/soil_validation/wheel_limit.h"
#include "host_sim/soil_validation/wheel_schedule.h"

namespace screed {

struct WheelTest {
  RollingWheel wheel;
  SoilParameters soil;
  SoilOptions options{.bulldozing = false, .avalanches = false};
  double mass_kg = 0.05;        ///< that moves up and down; the load is a force besides, 1e-4..1e4
  double speed_m_per_s = 0.05;  ///< ahead in the wheel's plane, 1e-4..10
  double step_s = 1e-3;         ///< 1e-5..0.02
  double duration_s = 6.0;      ///< of one pass; means are over its second half
  double cell_m = 0.005;        ///< 0.0005..0.1
  double offset_m = 0.0007;     ///< of the wheel's track across the grid
  double yaw_rad = 0.0;         ///< of the track against the grid's x axis
  int passes = 1;               ///< over the same track in the same direction, 1..100
  double belt_m = 0.0;          ///< between the axles of a belt, kept level, 0..10; 0: a wheel
  double lug_height_m = 0.0;    ///< footprint_contact.h, 0..0.1

  std::optional<ParticleMaterial> particle;  ///< what the ground is made of in place of soil
  double depth_m = 0.1;                      ///< of the bed of particles, 0.02..1
  uint64_t seed = 1;                         ///< of their layout
};

/// Means over the second half of a pass.
struct WheelPass {
  double sinkage_m = 0.0;  ///< of the wheel's lowest point below the untouched level
  double drawbar_pull_n = 0.0;
  double side_force_n = 0.0;
  double torque_nm = 0.0;
  double load_n = 0.0;    ///< that the soil supports
  double ripple_m = 0.0;  ///< highest minus lowest sinkage
  double rut_m = 0.0;     ///< depth of the rut behind the wheel after the pass, along its middle
};

struct WheelTestResult {
  std::vector<WheelPass> passes;
  VolumeBalance balance;
  HeightField surface;  ///< afterwards
};

/// On soil. Throws InputError for figures out of range.
WheelTestResult run_wheel(const WheelTest& test);

/// The wheel moves as a schedule says, after it has rolled in the schedule's first motion; a sample
/// every `interval_s`. Among particles the step is at most as long as they allow, and sinkage
/// counts from the mean height of their surface. The test's slip, slip angle, speed, duration and
/// passes do not count.
struct WheelScheduleResult {
  std::vector<WheelSample> samples;
  VolumeBalance balance;
};
WheelScheduleResult run_wheel(const WheelTest& test, const WheelSchedule& schedule,
                              double interval_s);

}  // namespace screed
