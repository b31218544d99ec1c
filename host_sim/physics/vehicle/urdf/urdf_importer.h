// Reads a robot model in the Unified Robot Description Format (URDF) into an Assembly. It knows
// files, XML and meshes, but no physics engine. docs/robot-model.md says which part of URDF is
// understood.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "host_sim/physics/vehicle/assembly.h"

namespace screed {

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
/// Throws InputError for everything that is wrong with the file, the meshes it names or the
/// options: a line for each fault that can be found at once, with the file, the line in it and the
/// element. Writes nothing to stdout or stderr. Does not depend on the locale.
Assembly import_urdf(const std::filesystem::path& file, const UrdfOptions& options = {});

}  // namespace screed
