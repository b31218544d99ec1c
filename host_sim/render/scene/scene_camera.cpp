// Camera and light.
#include "host_sim/render/scene/scene_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_sim/core/errors.h"
#include "host_sim/render/scene/povray.h"

namespace screed {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

struct NamedOrbit {
  const char* name;
  CameraOrbit orbit;
};
constexpr NamedOrbit kOrbits[] = {
    {"front", {38.0, 24.0, 0.72, false}}, {"back", {148.0, 30.0, 0.85, false}},
    {"side", {-90.0, 16.0, 0.70, false}}, {"above", {180.0, 80.0, 1.20, false}},
    {"bed", {-60.0, 38.0, 0.0, true}},
};

/// From the target to the camera, unit length.
Eigen::Vector3d direction(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad),
          std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad)};
}

/// Axes of a picture taken against `back`, the unit vector towards the camera.
Eigen::Matrix3d picture_axes(const Eigen::Vector3d& back) {
  Eigen::Matrix3d axes;
  axes.col(0) = Eigen::Vector3d::UnitZ().cross(back).normalized();
  axes.col(1) = back.cross(axes.col(0));
  axes.col(2) = back;
  return axes;
}

/// Tangents of half the field of view, right and up.
Eigen::Vector2d half_tangents(const PictureFormat& format) {
  const double right = std::tan(0.5 * format.field_of_view_deg * kRadPerDeg);
  return {right, right / format.aspect};
}

bool is_clear(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
              const std::function<double(double, double)>& ground_m) {
  constexpr double kStep_m = 0.01;
  constexpr double kClearance_m = 0.02;
  const Eigen::Vector3d ray = to - from;
  const int steps = static_cast<int>(ray.norm() / kStep_m);
  for (int i = 5; i <= steps; ++i) {  // the first 5 cm belong to what is looked at
    const Eigen::Vector3d at = from + ray * (static_cast<double>(i) / steps);
    if (at.z() < ground_m(at.x(), at.y()) + kClearance_m) return false;
  }
  return true;
}

}  // namespace

CameraOrbit camera_orbit(const std::string& text) {
  std::string names;
  for (const NamedOrbit& named : kOrbits) {
    if (text == named.name) return named.orbit;
    names += std::string(named.name) + ", ";
  }
  CameraOrbit orbit;
  int end = 0;
  const int read = std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &orbit.azimuth_deg,
                               &orbit.elevation_deg, &orbit.distance_m, &end);
  const bool ok = read == 3 && static_cast<size_t>(end) == text.size() &&
                  std::abs(orbit.azimuth_deg) <= 360.0 && orbit.elevation_deg >= 0.0 &&
                  orbit.elevation_deg <= 89.0 && orbit.distance_m >= 0.2 &&
                  orbit.distance_m <= 100.0;
  if (!ok) {
    throw InputError("camera = " + text + "; allowed is " + names +
                     "or AZIMUTH,ELEVATION,DISTANCE: degrees -360..360 from the robot's nose, "
                     "0..89 over the horizon, 0.2..100 m");
  }
  return orbit;
}

SceneCamera camera_at(const CameraOrbit& orbit, const Eigen::Vector3d& target, double heading_rad,
                      const std::function<double(double, double)>& ground_m) {
  constexpr double kHighest_deg = 88.0;
  constexpr double kStep_deg = 2.0;
  const double azimuth = orbit.azimuth_deg * kRadPerDeg + heading_rad;
  for (double elevation = orbit.elevation_deg;; elevation += kStep_deg) {
    const Eigen::Vector3d location =
        target + orbit.distance_m * direction(azimuth, elevation * kRadPerDeg);
    if (elevation >= kHighest_deg || orbit.whole_bed || is_clear(target, location, ground_m)) {
      return {location, target};
    }
  }
}

SceneCamera camera_around(const CameraOrbit& orbit, std::span<const Eigen::Vector3d> points,
                          const PictureFormat& format, double margin) {
  const Eigen::Matrix3d axes =
      picture_axes(direction(orbit.azimuth_deg * kRadPerDeg, orbit.elevation_deg * kRadPerDeg));
  const Eigen::Vector2d tangents = (1.0 - margin) * half_tangents(format);
  // In the picture's axes the camera is at (x, y, d), and a point p lies within the right edge when
  // p.x - x <= (d - p.z) t, within the left one when x - p.x <= (d - p.z) t. The points that are
  // outermost on both sides give the least d and the x in their middle; y likewise.
  Eigen::Vector3d place(0.0, 0.0, -std::numeric_limits<double>::infinity());
  double nearest = place.z();
  for (int axis = 0; axis < 2; ++axis) {
    const double tangent = tangents[axis];
    double plus = -std::numeric_limits<double>::infinity();
    double minus = plus;
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d p = axes.transpose() * point;
      plus = std::max(plus, p.z() * tangent + p[axis]);
      minus = std::max(minus, p.z() * tangent - p[axis]);
      nearest = std::max(nearest, p.z());
    }
    place[axis] = 0.5 * (plus - minus);
    place.z() = std::max(place.z(), 0.5 * (plus + minus) / tangent);
  }
  // A single point would have the camera in it. What belongs to the picture itself stands nearer.
  constexpr double kMinDistance_m = 0.12;
  place.z() = std::max(place.z(), nearest + kMinDistance_m);
  const Eigen::Vector3d target = axes * Eigen::Vector3d(place.x(), place.y(), nearest);
  return {axes * place, target};
}

Eigen::Vector3d project(const SceneCamera& camera, const PictureFormat& format,
                        const Eigen::Vector3d& point) {
  const Eigen::Isometry3d pose = picture_pose(camera, 0.0);
  const Eigen::Vector3d p = pose.inverse() * point;
  const Eigen::Vector2d tangents = half_tangents(format);
  return {p.x() / (-p.z() * tangents.x()), p.y() / (-p.z() * tangents.y()), -p.z()};
}

Eigen::Isometry3d picture_pose(const SceneCamera& camera, double depth_m) {
  const Eigen::Vector3d back = (camera.location - camera.target).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = picture_axes(back);
  pose.translation() = camera.location - depth_m * back;
  return pose;
}

std::string camera_text(const SceneCamera& camera, double field_of_view_deg) {
  constexpr double kSunDistance_m = 100.0;
  constexpr double kSunElevation = 27.0 * kRadPerDeg;
  const Eigen::Vector3d back = camera.location - camera.target;
  const double azimuth = std::atan2(back.y(), back.x());
  // Clockwise from behind the viewer is to the left of who looks at the target.
  const Eigen::Vector3d sun =
      kSunDistance_m * direction(azimuth - 75.0 * kRadPerDeg, kSunElevation);
  const Eigen::Vector3d fill =
      kSunDistance_m * direction(azimuth + 50.0 * kRadPerDeg, 50.0 * kRadPerDeg);
  std::string text =
      "camera {\n  location " + pov_vector(camera.location) +
      pov_line("\n  sky z up z right -x*image_width/image_height angle %.1f\n", field_of_view_deg) +
      "  look_at " + pov_vector(camera.target) + "\n}\n";
  text += "light_source { " + pov_vector(camera.target + sun) +
          " rgb <2.05,1.90,1.66> area_light <6,0,0>, <0,6,0>, 5, 5 adaptive 1 circular "
          "orient }\n";
  text +=
      "light_source { " + pov_vector(camera.target + fill) + " rgb <0.30,0.36,0.46> shadowless }\n";
  text +=
      "sky_sphere { pigment { gradient z color_map { [0.0 srgb <0.93,0.94,0.95>] [0.35 srgb "
      "<0.70,0.79,0.90>] [1.0 srgb <0.36,0.53,0.78>] } } }\n";
  return text;
}

}  // namespace screed
