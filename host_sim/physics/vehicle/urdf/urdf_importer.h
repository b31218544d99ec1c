// urdfdom behind a fence: it accepts a good deal that is wrong, prints, and keeps one log a
// process. Part of urdf_importer.
#pragma once

#include <tinyxml.h>
#include <urdf_model/model.h>
#include <urdf_world/types.h>
#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/urdf/urdf_document.h"

namespace screed::urdf_parts {

/// What urdfdom makes of a checked document; any error it logs is a refusal.
urdf::ModelInterfaceSharedPtr parse_model(const TiXmlDocument& xml, const Diagnostic& diagnostic);

Eigen::Vector3d to_eigen(const urdf::Vector3& v);
/// The pose of an element's <origin>, by its own numbers: urdfdom turns angles into a quaternion
/// whose bits depend on how it was compiled.
Eigen::Isometry3d origin_of(const TiXmlElement& element);

}  // namespace screed::urdf_parts

namespace screed {

// Reads a robot model in the Unified Robot Description Format (URDF) into an Assembly. It knows
// files, XML and meshes, but no physics engine. docs/robot-model.md says which part of URDF is
// understood.

struct UrdfOptions {
  /// The links with these roles, for models with names of their own; empty: found by name and
  /// place (docs/robot-model.md).
  std::string chassis_link;
  std::array<std::string, 4> wheel_links;  ///< front left, front right, rear left, rear right
  std::string imu_link;                    ///< fixed to the chassis

  /// Joints to hold still: joint name -> angle in rad, turned about the joint's <axis> from the
  /// pose the file gives. The joint becomes Fixed. The angle must lie within the <limit lower
  /// upper> of the joint, where it has one.
  std::map<std::string, double> joint_angles_rad;

  /// Turns the legs fl_Leg, fr_Leg, bl_Leg, br_Leg so that each points this far below the x axis of
  /// the chassis, whatever angle the file gives. With L the distance from leg joint to wheel axle,
  /// the height of the leg joints over the wheel axles is L sin(angle), and the axles stand L
  /// cos(angle) before or behind the leg joints: a greater angle lifts the chassis, keeps it level
  /// and shortens the wheelbase. Needs fixed joints <leg>_joint with an <axis> along y of the
  /// chassis.
  std::optional<double> leg_angle_rad;
};

/// Reads `file`. Mesh files are searched relative to its folder.
/// Throws InputError, one line with the file, the line in it and the element, for everything that
/// is wrong with the file, the meshes it names or the options. Writes nothing to stdout or stderr.
/// Does not depend on the locale.
Assembly import_urdf(const std::filesystem::path& file, const UrdfOptions& options = {});

}  // namespace screed
