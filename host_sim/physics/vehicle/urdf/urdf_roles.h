// Which links of a URDF file are the chassis, the wheels and the IMU. Part of urdf_importer.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "host_sim/physics/vehicle/urdf/urdf_document.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/physics/vehicle/urdf/urdf_joint.h"

namespace screed::urdf_parts {

/// Links as indices: [left, right][front, rear].
using WheelLinks = std::array<std::array<int, 2>, 2>;

/// The link that `options` names, or "Body", or "base_link", or the root; in place of a root
/// without mass the first link with mass that is fixed to it.
int find_chassis(const Outline& outline, const UrdfOptions& options, const Diagnostic& diagnostic);

/// The links that `options` names, or those with the thesis' names, or the four with "wheel" in
/// their name or their joint's that turn without end, by where they are. `poses`: of all links, in
/// the frame of the chassis.
WheelLinks find_wheels(const Outline& outline, const std::vector<Eigen::Isometry3d>& poses,
                       const UrdfOptions& options, const Diagnostic& diagnostic);

/// The link that `options` names, or "Imu", or "imu_link"; -1 without any of them.
int find_imu(const Outline& outline, const UrdfOptions& options, const Diagnostic& diagnostic);

/// A model of which no wheel is driven by the thesis' rule (limit velocity 1.0): drives all wheels
/// that turn without end.
void drive_wheels(const Outline& outline, const WheelLinks& wheels, std::vector<JointData>& joints);

}  // namespace screed::urdf_parts
