// URDF joints: what kind they are, how they are held, where they put their links. Part of
// urdf_importer.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/urdf/urdf_document.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"

namespace screed::urdf_parts {

// A joint as the file gives it, before anything is placed.
struct JointData {
  AssemblyJoint::Kind kind = AssemblyJoint::Kind::Fixed;
  // Joint frame at angle 0, in the parent.
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  std::optional<Eigen::Vector3d> axis;  // unit, in the joint frame
  bool has_range = false;               // lower or upper was given, and counts
  double lower_rad = 0.0;
  double upper_rad = 0.0;
  double effort_n_m = 0.0;
  std::optional<double> held_at_rad;
};

JointData to_joint(const JointElement& element, const ::urdf::Joint& joint, Diagnostic& diagnostic);
/// Holds a joint at an angle; refuses one without axis or out of range.
void hold(JointData& joint, const JointElement& element, double angle_rad, Diagnostic& diagnostic);
/// As UrdfOptions::leg_angle_rad says.
void set_leg_angle(double angle_rad, const Outline& outline, int chassis,
                   std::vector<JointData>& joints, Diagnostic& diagnostic);
/// Poses of all links in the frame of the chassis.
std::vector<Eigen::Isometry3d> link_poses(const Outline& outline, int chassis,
                                          const std::vector<JointData>& joints);

// Which links of a URDF file are the chassis, the wheels and the IMU. Part of urdf_importer.

/// Links as indices: [left, right][front, rear].
using WheelLinks = std::array<std::array<int, 2>, 2>;

/// The link that `options` names, or "Body", or "base_link", or the root; in place of a root
/// without mass the first link with mass that is fixed to it.
int find_chassis(const Outline& outline, const UrdfOptions& options, Diagnostic& diagnostic);

/// The links that `options` names, or those with the thesis' names, or the four with "wheel" in
/// their name or their joint's that turn without end, by where they are. `poses`: of all links, in
/// the frame of the chassis.
WheelLinks find_wheels(const Outline& outline, const std::vector<Eigen::Isometry3d>& poses,
                       const UrdfOptions& options, Diagnostic& diagnostic);

/// The link that `options` names, or "Imu", or "imu_link"; -1 without any of them.
int find_imu(const Outline& outline, const UrdfOptions& options, Diagnostic& diagnostic);

/// A model of which no wheel is driven by the thesis' rule (limit velocity 1.0): drives all wheels
/// that turn without end.
void drive_wheels(const Outline& outline, const WheelLinks& wheels, std::vector<JointData>& joints);

}  // namespace screed::urdf_parts
