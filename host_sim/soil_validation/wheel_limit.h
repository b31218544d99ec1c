// What a rigid wheel on soil does when the grid is infinitely fine and the step infinitely short:
// the equations of the contact, integrated along it. Knows no grid; docs/studies/soil.md states the
// equations.
#pragma once

#include <limits>

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

/// Throws InputError for a figure out of range, and as `at_axle` says.
WheelReaction wheel_limit(const RollingWheel& wheel, const SoilParameters& soil,
                          NormalStress normal_stress, AtAxle at_axle = AtAxle::kThrow);

}  // namespace screed
