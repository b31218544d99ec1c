// A robot seen from above: where it is, and how far it comes in a frame of 10 ms.
#pragma once

#include <array>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/drive_train.h"
#include "host_sim/physics/vehicle/vehicle_options.h"

namespace screed {

/// A frame's motion in the robot's own axes.
struct FrameMotion {
  double forward_m = 0.0;
  double sideways_m = 0.0;  ///< to the left
  double turn_rad = 0.0;    ///< counter-clockwise
};

struct PlanarPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;  ///< counter-clockwise from east, not wrapped

  /// Along an arc: half of the turn comes first.
  void move(const FrameMotion& motion);
  /// From `earlier` to here, in the axes of here.
  FrameMotion since(const PlanarPose& earlier) const;
};

// The tracks of a robot as the stand-in sees them: two belts round two wheels each, a mass on top.

struct TrackGeometry {
  double half_length_m = 0.0925;  ///< half the distance of the axles
  double radius_m = 0.03;         ///< of the wheels, belt included
  double width_m = 0.03;
  double half_tread_m = 0.0975;      ///< to the middle of a track
  double below_m = 0.0613;           ///< of the tracks' lower run under the robot's origin
  double mass_kg = 1.2;              ///< of the robot
  double mass_ahead_m = 0.0;         ///< its centre, ahead of the origin
  double mass_height_m = 0.0534;     ///< and over the lower run
  double yaw_inertia_kg_m2 = 0.009;  ///< about that centre's vertical
  double lug_height_m = 0.002;       ///< of the tread
  double friction = 0.8;             ///< of rubber, where the tread has not sunk in
};
/// Of the left side's wheels.
TrackGeometry track_geometry(const Assembly& robot, const VehicleOptions& options);

/// The plane of the tracks' lower runs: its height where the robot's vertical axis meets it, and
/// its slopes forward and to the left (rise over run).
struct TrackPlane {
  double height_m = 0.0;
  double forward = 0.0;
  double left = 0.0;
};

// A robot in the middle of a drive: what it takes to go on from there.

struct DrivingState {
  PlanarPose pose;
  FrameMotion last;  ///< of the last frame
  std::array<double, 2> track_speed_m_per_s{};
  std::array<double, 2> shaft_angle_rad{};
  Battery battery;
};

}  // namespace screed
