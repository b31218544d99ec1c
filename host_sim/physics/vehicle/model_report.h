// What a robot model amounts to as a vehicle, what about it is doubtful, and whether a world would
// refuse it. Knows no files and no physics engine.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/vehicle_options.h"

namespace screed {

struct ModelReport {
  double mass_kg = 0.0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< of mass, in the frame of the chassis, m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about it, axes of the chassis, kg m^2
  Eigen::Vector3d imu = Eigen::Vector3d::Zero();      ///< place, in the frame of the chassis, m
  double tread_m = 0.0;                               ///< between the sides' centre lines
  double wheelbase_m = 0.0;                           ///< between the axles
  /// Of the lowest collision shape over the ground, wheels aside; not finite without any.
  double clearance_m = 0.0;
  std::vector<std::string> warnings;  ///< one line each
};

/// The model as drawn, every joint at zero. Throws InputError as VehicleParts does where a world
/// with these options would; with `either_drive` only when the other choice of tracks or wheels is
/// refused as well, else it is a warning.
ModelReport report_model(const Assembly& assembly, const VehicleOptions& options = {},
                         bool either_drive = true);

}  // namespace screed
