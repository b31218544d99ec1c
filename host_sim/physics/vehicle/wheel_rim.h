// The cylinder that a wheel rolls on, from the shapes of its link.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "host_sim/physics/vehicle/assembly.h"

namespace screed {

/// A cylinder about an axle through the origin of the wheel's link.
struct WheelRim {
  double radius_m = 0.0;
  double width_m = 0.0;
  double offset_m = 0.0;    ///< of its middle from the link's origin, along the axle
  const char* source = "";  ///< "collision cylinder", "visual mesh"
};

/// `axle`: unit vector in the frame of the wheel's link. The shapes are those of `collision`, of a
/// wheel without any those of `visual`; the first rule that applies counts:
///   cylinder  the first one, which must lie along the axle;
///   sphere    its radius; as wide as the wheel's cylinders and meshes in `visual` are, else as its
///             radius;
///   meshes    the smallest cylinder about the axle that holds all of them.
/// Throws InputError without the wheel's name, as "has ...": no such shape; a cylinder across the
/// axle (more than 5 degrees off); a shape beside the axle (by more than a tenth of its radius).
WheelRim wheel_rim(const AssemblyBody& wheel, const Eigen::Vector3d& axle);

}  // namespace screed
