// URDF joints: what kind they are, how they are held, where they put their links. Part of
// urdf_importer.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/urdf/urdf_document.h"
#include "host_sim/physics/vehicle/urdf/urdf_model.h"

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

JointData to_joint(const JointElement& element, const urdf::Joint& joint,
                   const Diagnostic& diagnostic);
/// Holds a joint at an angle; refuses one without axis or out of range.
void hold(JointData& joint, const JointElement& element, double angle_rad,
          const Diagnostic& diagnostic);
/// As UrdfOptions::leg_angle_rad says.
void set_leg_angle(double angle_rad, const Outline& outline, int chassis,
                   std::vector<JointData>& joints, const Diagnostic& diagnostic);
/// Poses of all links in the frame of the chassis.
std::vector<Eigen::Isometry3d> link_poses(const Outline& outline, int chassis,
                                          const std::vector<JointData>& joints);

}  // namespace screed::urdf_parts
