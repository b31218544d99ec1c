// Where a scene is seen from.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <span>
#include <string>

namespace screed {

/// A place round what is looked at: azimuth counter-clockwise from the robot's nose (0: from
/// ahead), elevation over the horizon, degrees; distance in metres.
struct CameraOrbit {
  double azimuth_deg = 140.0;
  double elevation_deg = 28.0;
  double distance_m = 0.75;
  bool whole_bed = false;  ///< looks at the bed's middle instead of the robot; azimuth from east
};

/// A name (`front`, `back`, `side`, `above`, `bed`) or "AZIMUTH,ELEVATION,DISTANCE". Throws
/// InputError that lists what is allowed.
CameraOrbit camera_orbit(const std::string& text);

struct SceneCamera {
  Eigen::Vector3d location;
  Eigen::Vector3d target;
};

/// The camera on `orbit` round `target`; heading_rad is that of the robot. It is moved up until
/// nothing of the ground stands between it and the target.
SceneCamera camera_at(const CameraOrbit& orbit, const Eigen::Vector3d& target, double heading_rad,
                      const std::function<double(double x, double y)>& ground_m);

/// What a picture shows of the world: its width in degrees, and its width over its height.
struct PictureFormat {
  double field_of_view_deg = 40.0;
  double aspect = 1.6;
};

/// A camera in the direction of `orbit` from what it looks at, just so far away that all points lie
/// in the picture, `margin` of its half width and height (0..1) from its edges. The orbit's
/// distance has no say; azimuth from east. `points` has at least one.
SceneCamera camera_around(const CameraOrbit& orbit, std::span<const Eigen::Vector3d> points,
                          const PictureFormat& format, double margin);

/// Where a point appears: x to the right and y upwards, -1..1 within the picture; z: its depth
/// before the camera, m.
Eigen::Vector3d project(const SceneCamera& camera, const PictureFormat& format,
                        const Eigen::Vector3d& point);

/// From the axes of the picture (x right, y up, z towards the viewer) to the world, with its origin
/// `depth_m` before the camera.
Eigen::Isometry3d picture_pose(const SceneCamera& camera, double depth_m);

/// Camera, sun, sky and a soft light from the other side. The sun stands behind the viewer's left
/// shoulder and low, so that ruts throw shadows.
std::string camera_text(const SceneCamera& camera, double field_of_view_deg);

}  // namespace screed
