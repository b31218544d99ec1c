// Cylinders, spheres and meshes about an axle.
#include "host_sim/physics/vehicle/wheel_rim.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <variant>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr double kMaxTilt_deg = 5.0;
constexpr double kMaxEccentricity = 0.1;  // of the radius

std::string number(double value, const char* format) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

void check_centre(const char* kind, double beside_m, double radius_m) {
  if (beside_m <= kMaxEccentricity * radius_m) return;
  throw InputError(std::string("has a ") + kind + " whose middle is " +
                   number(1e3 * beside_m, "%.1f") + " mm beside the axle");
}

double beside(const Eigen::Vector3d& point, const Eigen::Vector3d& axle) {
  return (point - axle * axle.dot(point)).norm();
}

template <class Geometry>
const Shape* first_of(const std::vector<Shape>& shapes) {
  const auto found = std::find_if(shapes.begin(), shapes.end(), [](const Shape& shape) {
    return std::holds_alternative<Geometry>(shape.geometry);
  });
  return found == shapes.end() ? nullptr : &*found;
}

WheelRim rim_of_cylinder(const Shape& shape, const Eigen::Vector3d& axle) {
  const auto& cylinder = std::get<Cylinder>(shape.geometry);
  const double along = std::abs(axle.dot(shape.pose.linear().col(2)));
  const double tilt_deg = portable::acos(std::min(1.0, along)) * 180.0 / std::numbers::pi;
  if (tilt_deg > kMaxTilt_deg) {
    throw InputError("has a cylinder that lies " + number(tilt_deg, "%.0f") +
                     " degrees off the axle: URDF's cylinders lie along z of their <origin>, which "
                     "rpy=\"1.5707963 0 0\" turns to y");
  }
  const Eigen::Vector3d middle = shape.pose.translation();
  check_centre("cylinder", beside(middle, axle), cylinder.radius);
  return {cylinder.radius, cylinder.length, axle.dot(middle), ""};
}

std::optional<WheelRim> rim_of_meshes(const std::vector<Shape>& shapes,
                                      const Eigen::Vector3d& axle) {
  const Eigen::Vector3d across = axle.unitOrthogonal();
  Eigen::Matrix3d to_axle;
  to_axle << across.transpose(), axle.cross(across).transpose(), axle.transpose();
  Eigen::AlignedBox3d bounds;
  double radius = 0.0;
  for (const Shape& shape : shapes) {
    const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry);
    if (mesh == nullptr) continue;
    for (const Eigen::Vector3d& vertex : mesh->vertices) {
      const Eigen::Vector3d at = to_axle * (shape.pose * vertex);
      bounds.extend(at);
      radius = std::max(radius, at.head<2>().norm());
    }
  }
  if (bounds.isEmpty()) return std::nullopt;
  check_centre("mesh", bounds.center().head<2>().norm(), radius);
  return WheelRim{radius, bounds.sizes().z(), bounds.center().z(), ""};
}

WheelRim rim_of_sphere(const Shape& shape, const AssemblyBody& wheel, const Eigen::Vector3d& axle) {
  const double radius = std::get<Sphere>(shape.geometry).radius;
  const Eigen::Vector3d middle = shape.pose.translation();
  check_centre("sphere", beside(middle, axle), radius);
  double width = radius;
  if (const Shape* drawn = first_of<Cylinder>(wheel.visual)) {
    width = rim_of_cylinder(*drawn, axle).width_m;
  } else if (const auto meshes = rim_of_meshes(wheel.visual, axle)) {
    width = meshes->width_m;
  }
  return {radius, std::min(width, 2.0 * radius), axle.dot(middle), ""};
}

}  // namespace

WheelRim wheel_rim(const AssemblyBody& wheel, const Eigen::Vector3d& axle) {
  const bool visual = wheel.collision.empty();
  const std::vector<Shape>& shapes = visual ? wheel.visual : wheel.collision;
  const auto from = [visual](WheelRim rim, const char* of_visual, const char* of_collision) {
    rim.source = visual ? of_visual : of_collision;
    return rim;
  };
  if (const Shape* cylinder = first_of<Cylinder>(shapes)) {
    return from(rim_of_cylinder(*cylinder, axle), "visual cylinder", "collision cylinder");
  }
  if (const Shape* sphere = first_of<Sphere>(shapes)) {
    return from(rim_of_sphere(*sphere, wheel, axle), "visual sphere", "collision sphere");
  }
  if (const auto meshes = rim_of_meshes(shapes, axle)) {
    return from(*meshes, "visual mesh", "collision mesh");
  }
  throw InputError(
      "has no shape to roll on: a wheel needs a cylinder, a sphere or a mesh, in "
      "<collision> or else in <visual>");
}

}  // namespace screed
