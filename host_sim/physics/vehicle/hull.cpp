// Points and boxes on the ground.
#include "host_sim/physics/vehicle/hull.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <variant>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"

namespace screed {
namespace {

constexpr double kHullSpacing_m = 0.04;  // of contact points on boxes
constexpr double kHullSinkIn_m = 0.001;  // when four points carry the whole robot

// Points on the surface of a shape, dense enough that the ground cannot pass between them
// unnoticed.
void add_hull_points(const Shape& shape, const Eigen::Isometry3d& pose,
                     std::vector<Eigen::Vector3d>& points) {
  const Eigen::Isometry3d at = pose * shape.pose;
  if (const auto* box = std::get_if<Box>(&shape.geometry)) {
    Eigen::Vector3i count;
    for (int axis = 0; axis < 3; ++axis) {
      count[axis] = std::max(1, static_cast<int>(std::ceil(box->size[axis] / kHullSpacing_m)));
    }
    for (int i = 0; i <= count.x(); ++i) {
      for (int j = 0; j <= count.y(); ++j) {
        for (int k = 0; k <= count.z(); ++k) {
          const bool surface =
              i == 0 || j == 0 || k == 0 || i == count.x() || j == count.y() || k == count.z();
          if (!surface) continue;
          const Eigen::Vector3d share(static_cast<double>(i) / count.x() - 0.5,
                                      static_cast<double>(j) / count.y() - 0.5,
                                      static_cast<double>(k) / count.z() - 0.5);
          points.emplace_back(at * share.cwiseProduct(box->size));
        }
      }
    }
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    constexpr int kAround = 12;
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAround;
      for (const double end : {-0.5, 0.5}) {
        points.emplace_back(at * Eigen::Vector3d(cylinder->radius * portable::cos(angle),
                                                 cylinder->radius * portable::sin(angle),
                                                 end * cylinder->length));
      }
    }
  } else if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    constexpr int kAround = 12;
    constexpr int kRings = 6;  // between the poles
    for (int ring = 0; ring <= kRings; ++ring) {
      const double polar = std::numbers::pi * ring / kRings;
      const int count = ring == 0 || ring == kRings ? 1 : kAround;
      for (int i = 0; i < count; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kAround;
        const Eigen::Vector3d direction(portable::sin(polar) * portable::cos(angle),
                                        portable::sin(polar) * portable::sin(angle),
                                        -portable::cos(polar));
        points.emplace_back(at * (sphere->radius * direction));
      }
    }
  } else if (const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry)) {
    for (const Eigen::Vector3d& vertex : mesh->vertices) points.emplace_back(at * vertex);
  }
}

struct HullBox {
  Eigen::Isometry3d pose;
  Eigen::Vector3d size;
};

// The box that stands for a shape as a footprint: itself, or the box round another shape.
std::optional<HullBox> box_of(const Shape& shape, const Eigen::Isometry3d& pose) {
  Eigen::Isometry3d at = pose * shape.pose;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  if (const auto* box = std::get_if<Box>(&shape.geometry)) {
    size = box->size;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    size = {2.0 * cylinder->radius, 2.0 * cylinder->radius, cylinder->length};
  } else if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    size.setConstant(2.0 * sphere->radius);
  } else if (const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry)) {
    Eigen::AlignedBox3d bounds;
    for (const Eigen::Vector3d& vertex : mesh->vertices) bounds.extend(vertex);
    if (bounds.isEmpty()) return std::nullopt;
    size = bounds.sizes();
    at = at * Eigen::Translation3d(bounds.center());
  }
  return HullBox{at, size};
}

}  // namespace

void Hull::add(const Shape& shape, const Eigen::Isometry3d& pose) {
  add_hull_points(shape, pose, points_);
  const std::optional<HullBox> box = box_of(shape, pose);
  if (!box) return;
  boxes_.push_back(Footprint::box(box->size));
  box_poses_.push_back(box->pose);
  reach_ = std::max(reach_, box->pose.translation().norm() + 0.5 * box->size.norm());
}

void Hull::close(double friction, double robot_kg) {
  law_.friction = friction;
  law_.stiffness = robot_kg * kGravity_m_per_s2 / (4.0 * kHullSinkIn_m);
  law_.damping = std::sqrt(law_.stiffness * robot_kg / 4.0);
  for (const Eigen::Vector3d& point : points_) reach_ = std::max(reach_, point.norm());
  reset_contacts();
}

void Hull::reset_contacts() {
  bristles_.assign(points_.size(), Eigen::Vector3d::Zero());
  box_memories_.assign(boxes_.size(), ContactMemory{});
}

// Without calls in its loop, as RunningGear::stand_on.
[[gnu::flatten]] void Hull::stand_on(const HeightField& hard, const CarrierMotion& motion,
                                     double dt, Wrench& wrench) {
  const double ceiling =
      hard.max_height_within(motion.origin.x(), motion.origin.y(), reach_) - motion.origin.z();
  const Eigen::RowVector3d upwards = motion.rotation.row(2);
  touches_.clear();
  TerrainContact contact;
  for (size_t i = 0; i < points_.size(); ++i) {
    if (upwards.dot(points_[i]) > ceiling) {
      bristles_[i].setZero();
      continue;
    }
    const Eigen::Vector3d arm = motion.rotation * points_[i];
    if (!find_contact(hard, motion.origin + arm, contact)) {
      bristles_[i].setZero();
      continue;
    }
    touches_.add(i, points_[i], arm, contact);
  }
  if (touches_.touches().empty()) return;
  const ContactLaw law = touches_.softened(law_, motion, dt);
  for (const GroundTouches::Touch& touch : touches_.touches()) {
    const Eigen::Vector3d velocity = motion.velocity + motion.omega.cross(touch.arm);
    wrench.add(contact_force(law, touch.contact, velocity, velocity, dt, bristles_[touch.point]),
               touch.arm);
  }
}

void Hull::add_footprint_contacts(const Terrain& terrain, const CarrierMotion& motion,
                                  std::vector<FootprintContact>& contacts) {
  const double ceiling = terrain.max_height_within(motion.origin.x(), motion.origin.y(), reach_);
  for (size_t i = 0; i < boxes_.size(); ++i) {
    Eigen::Isometry3d pose = box_poses_[i];
    const Eigen::Vector3d arm = motion.rotation * pose.translation();
    pose.linear() = motion.rotation * pose.linear();
    pose.translation() = motion.origin + arm;
    Footprint& box = boxes_[i];
    box.set_pose(pose);
    if (pose.translation().z() - box.reach_down() > ceiling) {
      box_memories_[i] = {};
      continue;
    }
    FootprintContact contact;
    contact.footprint = &box;
    contact.memory = &box_memories_[i];
    contact.motion.velocity = motion.velocity + motion.omega.cross(arm);
    contact.motion.omega = motion.omega;
    contact.motion.friction = law_.friction;
    contact.motion.soil_friction = law_.friction;  // smooth: no soil sticks to it
    contact.arm = arm;
    contacts.push_back(contact);
  }
}

}  // namespace screed
