// The place on a body's surface that is nearest to a point.
#include "host_sim/physics/particles/solid_touch.h"

#include <algorithm>
#include <cmath>

namespace screed {
namespace {

/// A prism's cross section at a point: distance from its outline and the way out.
struct Outline {
  double distance;      // negative inside
  Eigen::Vector3d out;  // unit length, at right angles to the prism's axis
};

/// The nearest surface of a prism along `axis` of half length `half`, from where the point is
/// along the axis and in the cross section.
SolidTouch on_prism(const Eigen::Vector3d& point, const Outline& outline, int axis, double half) {
  SolidTouch touch{};
  const double along = point[axis];
  const double beyond = std::abs(along) - half;
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  end[axis] = along < 0.0 ? -1.0 : 1.0;
  if (beyond <= 0.0 && (outline.distance >= 0.0 || outline.distance >= beyond)) {
    touch.distance = outline.distance;
    touch.normal = outline.out;
  } else if (outline.distance <= 0.0) {
    touch.distance = beyond;
    touch.normal = end;
  } else {  // beyond the rim
    touch.distance = std::hypot(outline.distance, beyond);
    touch.normal = (outline.distance * outline.out + beyond * end) / touch.distance;
  }
  touch.surface = point - touch.distance * touch.normal;
  touch.belt.setZero();
  return touch;
}

SolidTouch on_track(const Footprint& solid, const Eigen::Vector3d& point) {
  const double run = solid.half().x();
  const double dx = point.x() - std::clamp(point.x(), -run, run);
  const double size = std::hypot(dx, point.z());
  Outline outline{size - solid.radius(), Eigen::Vector3d::UnitZ()};
  if (size > 0.0) outline.out = Eigen::Vector3d(dx, 0.0, point.z()) / size;
  SolidTouch touch = on_prism(point, outline, 1, solid.half().y());
  // The belt goes forward on top; on the side of a wheel it is slower towards the axle.
  const double share = std::min(1.0, size / solid.radius());
  touch.belt = share * Eigen::Vector3d(outline.out.z(), 0.0, -outline.out.x());
  return touch;
}

SolidTouch on_disc(const Footprint& solid, const Eigen::Vector3d& point) {
  const double size = std::hypot(point.x(), point.y());
  Outline outline{size - solid.radius(), Eigen::Vector3d::UnitX()};
  if (size > 0.0) outline.out = Eigen::Vector3d(point.x(), point.y(), 0.0) / size;
  return on_prism(point, outline, 2, solid.half().z());
}

SolidTouch on_box(const Footprint& solid, const Eigen::Vector3d& point) {
  SolidTouch touch{};
  touch.belt.setZero();
  const Eigen::Vector3d& half = solid.half();
  touch.surface = point.cwiseMax(-half).cwiseMin(half);
  const Eigen::Vector3d out = point - touch.surface;
  touch.distance = out.norm();
  if (touch.distance > 0.0) {
    touch.normal = out / touch.distance;
    return touch;
  }
  int axis = 0;
  const double depth = (half - point.cwiseAbs()).minCoeff(&axis);
  touch.distance = -depth;
  touch.normal.setZero();
  touch.normal[axis] = point[axis] < 0.0 ? -1.0 : 1.0;
  touch.surface = point + depth * touch.normal;
  return touch;
}

}  // namespace

SolidTouch nearest_on(const Footprint& solid, const Eigen::Vector3d& point) {
  switch (solid.kind()) {
    case Footprint::Kind::kTrack:
      return on_track(solid, point);
    case Footprint::Kind::kDisc:
      return on_disc(solid, point);
    case Footprint::Kind::kBox:
      break;
  }
  return on_box(solid, point);
}

}  // namespace screed
