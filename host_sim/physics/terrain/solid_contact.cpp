// The place on a body's surface that is nearest to a point.
#include "host_sim/physics/terrain/solid_contact.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/elementary.h"

namespace screed {
namespace {

/// A prism's cross section at a point: distance from its outline and the way out.
struct Outline {
  double distance;      // negative inside
  Eigen::Vector3d out;  // unit length, at right angles to the prism's axis
};

/// The nearest surface of a prism along `axis` of half length `half`, from where the point is
/// along the axis and in the cross section.
SolidContact on_prism(const Eigen::Vector3d& point, const Outline& outline, int axis, double half) {
  SolidContact contact{};
  const double along = point[axis];
  const double beyond = std::abs(along) - half;
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  end[axis] = along < 0.0 ? -1.0 : 1.0;
  if (beyond <= 0.0 && (outline.distance >= 0.0 || outline.distance >= beyond)) {
    contact.distance = outline.distance;
    contact.normal = outline.out;
  } else if (outline.distance <= 0.0) {
    contact.distance = beyond;
    contact.normal = end;
  } else {  // beyond the rim
    contact.distance = portable::hypot(outline.distance, beyond);
    contact.normal = (outline.distance * outline.out + beyond * end) / contact.distance;
  }
  contact.surface = point - contact.distance * contact.normal;
  contact.belt.setZero();
  return contact;
}

SolidContact on_track(const Footprint& solid, const Eigen::Vector3d& point) {
  const double run = solid.half().x();
  const double dx = point.x() - std::clamp(point.x(), -run, run);
  const double size = portable::hypot(dx, point.z());
  Outline outline{size - solid.radius(), Eigen::Vector3d::UnitZ()};
  if (size > 0.0) outline.out = Eigen::Vector3d(dx, 0.0, point.z()) / size;
  SolidContact contact = on_prism(point, outline, 1, solid.half().y());
  // The belt goes forward on top; on the side of a wheel it is slower towards the axle.
  const double share = std::min(1.0, size / solid.radius());
  contact.belt = share * Eigen::Vector3d(outline.out.z(), 0.0, -outline.out.x());
  return contact;
}

SolidContact on_disc(const Footprint& solid, const Eigen::Vector3d& point) {
  const double size = portable::hypot(point.x(), point.y());
  Outline outline{size - solid.radius(), Eigen::Vector3d::UnitX()};
  if (size > 0.0) outline.out = Eigen::Vector3d(point.x(), point.y(), 0.0) / size;
  return on_prism(point, outline, 2, solid.half().z());
}

SolidContact on_box(const Footprint& solid, const Eigen::Vector3d& point) {
  SolidContact contact{};
  contact.belt.setZero();
  const Eigen::Vector3d& half = solid.half();
  contact.surface = point.cwiseMax(-half).cwiseMin(half);
  const Eigen::Vector3d out = point - contact.surface;
  contact.distance = out.norm();
  if (contact.distance > 0.0) {
    contact.normal = out / contact.distance;
    return contact;
  }
  int axis = 0;
  const double depth = (half - point.cwiseAbs()).minCoeff(&axis);
  contact.distance = -depth;
  contact.normal.setZero();
  contact.normal[axis] = point[axis] < 0.0 ? -1.0 : 1.0;
  contact.surface = point + depth * contact.normal;
  return contact;
}

}  // namespace

SolidContact nearest_on(const Footprint& solid, const Eigen::Vector3d& point) {
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
