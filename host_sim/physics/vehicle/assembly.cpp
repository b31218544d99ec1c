// Names, rigid groups and composed inertias of an assembly.
#include "host_sim/physics/vehicle/assembly.h"

#include <algorithm>
#include <cstddef>

namespace screed {
namespace {

template <typename Named>
int index_of(const std::vector<Named>& items, std::string_view name) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace

bool Assembly::is_wheel(int body) const {
  return std::any_of(wheels.begin(), wheels.end(), [body](const auto& side) {
    return side[0].body == body || side[1].body == body;
  });
}

const AssemblyJoint* Assembly::joint_to(int body) const {
  for (const AssemblyJoint& joint : joints) {
    if (joint.child == body) return &joint;
  }
  return nullptr;
}

int Assembly::body_index(std::string_view body_name) const {
  return index_of(bodies, body_name);
}

int Assembly::joint_index(std::string_view joint_name) const {
  return index_of(joints, joint_name);
}

Inertia transformed(const Eigen::Isometry3d& frame, const Inertia& inertia) {
  return {inertia.mass, frame * inertia.pose, inertia.tensor};
}

Inertia compose(const std::vector<Inertia>& parts) {
  Inertia whole;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const Inertia& part : parts) {
    whole.mass += part.mass;
    moment += part.mass * part.pose.translation();
  }
  if (whole.mass <= 0.0) return Inertia{};
  const Eigen::Vector3d centre = moment / whole.mass;
  whole.pose.translation() = centre;
  for (const Inertia& part : parts) {
    const Eigen::Matrix3d rotation = part.pose.linear();
    const Eigen::Vector3d offset = part.pose.translation() - centre;
    whole.tensor += rotation * part.tensor * rotation.transpose();
    whole.tensor += part.mass * (offset.squaredNorm() * Eigen::Matrix3d::Identity() -
                                 offset * offset.transpose());
  }
  return whole;
}

std::vector<int> rigid_group(const Assembly& assembly, int body) {
  std::vector<bool> member(assembly.bodies.size(), false);
  member[static_cast<std::size_t>(body)] = true;
  // A pass carries membership over every fixed joint; a chain against the order of the joints needs
  // several.
  for (bool grown = true; grown;) {
    grown = false;
    for (const AssemblyJoint& joint : assembly.joints) {
      if (joint.kind != AssemblyJoint::Kind::Fixed) continue;
      const auto parent = static_cast<std::size_t>(joint.parent);
      const auto child = static_cast<std::size_t>(joint.child);
      if (member[parent] == member[child]) continue;
      member[parent] = member[child] = true;
      grown = true;
    }
  }
  std::vector<int> group;
  for (std::size_t i = 0; i < member.size(); ++i) {
    if (member[i]) group.push_back(static_cast<int>(i));
  }
  return group;
}

Inertia composed_inertia(const Assembly& assembly, const std::vector<int>& bodies) {
  std::vector<Inertia> parts;
  for (const int index : bodies) {
    const AssemblyBody& body = assembly.bodies[static_cast<std::size_t>(index)];
    parts.push_back(transformed(body.pose, body.inertia));
  }
  return compose(parts);
}

}  // namespace screed
