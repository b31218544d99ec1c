// A wheel rolling on soil: the limit of an infinitely fine grid, and one in a single-wheel testbed.
#pragma once

#include <limits>
#include <vector>

#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/soil/soil_parameters.h"

namespace screed {

/// A driven wheel at a given load and slip, rolling steadily over level soil, or along a rut that
/// an earlier pass has left in it.
struct RollingWheel {
  double radius_m = 0.03;
  double width_m = 0.025;
  double load_n = 3.0;
  /// (rim speed - speed ahead) / the larger of both, -1..0.99: driven above 0, braked below, -1
  /// locked.
  double slip = 0.2;
  double rut_m = 0.0;  ///< depth of that rut (the plastic sinkage), 0..radius; 0: untouched soil
  double slip_angle_rad = 0.0;  ///< of its travel to the left of its plane, -1.4..1.4
  /// Of the rim against soil, tangent of the angle; infinite: rough, soil shears on soil.
  double friction = std::numeric_limits<double>::infinity();
  double adhesion_pa = 0.0;  ///< of soil to the rim
};

struct WheelReaction {
  double sinkage_m = 0.0;        ///< of the wheel's lowest point below the untouched level
  double drawbar_pull_n = 0.0;   ///< horizontal force of the soil, forward
  double side_force_n = 0.0;     ///< of the soil, to the left
  double torque_nm = 0.0;        ///< that the axle needs
  double contact_front_m = 0.0;  ///< where contact begins ahead of the axle, ...
  double contact_rear_m = 0.0;   ///< ... and ends behind it
  double rut_m = 0.0;            ///< depth of the rut it leaves
};

/// What wheel_limit() does with a load that is more than soil can bear at the wheel's full depth,
/// its radius.
enum class AtAxle {
  kThrow,       ///< InputError
  kTakeForces,  ///< gives the forces at that depth, scaled to the load; for fits, on their way
};

/// What a rigid wheel on soil does when the grid is infinitely fine and the step infinitely short:
/// the equations of the contact, integrated along it. Knows no grid; docs/studies/soil.md states
/// the equations. Throws InputError for a figure out of range, and as `at_axle` says.
WheelReaction wheel_limit(const RollingWheel& wheel, const SoilParameters& soil,
                          NormalStress normal_stress, AtAxle at_axle = AtAxle::kThrow);

/// A single driven wheel whose travel and spin are imposed and that is free up and down, as in a
/// single-wheel testbed.
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

/// Throws InputError for figures out of range.
WheelTestResult run_wheel(const WheelTest& test);

}  // namespace screed
