// Kinds, ranges and angles of joints.
#include "host_sim/physics/vehicle/urdf/urdf_joint.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "host_sim/core/elementary.h"
#include "host_sim/core/rotation.h"

namespace screed::urdf_parts {
namespace {

// The thesis' mark of a powered joint, section 5.2.
constexpr double kMotorVelocity = 1.0;
// A limit written with six decimals still includes its own value.
constexpr double kAngleTolerance_rad = 1e-6;

// A fixed joint's axis is of use too (it can be held at another angle), but urdfdom drops it: read
// from the XML.
std::optional<Eigen::Vector3d> joint_axis(const JointElement& joint, const Diagnostic& diagnostic) {
  const TiXmlElement* element = joint.xml->FirstChildElement("axis");
  if (element == nullptr) {
    if (joint.type == "fixed") return {};
    return Eigen::Vector3d::UnitX();  // the default of URDF
  }
  const std::vector<double> xyz = parse_numbers(attribute(*element, "xyz"));
  const Eigen::Vector3d axis(xyz[0], xyz[1], xyz[2]);
  // stableNorm: neither overflow nor underflow makes an odd axis look like zero.
  if (axis.stableNorm() == 0.0) {
    diagnostic.at_element(*element, "<axis> is zero; it needs a direction");
  }
  return axis.stableNormalized();
}

bool in_range(const JointData& joint, double angle_rad) {
  return !joint.has_range || (angle_rad >= joint.lower_rad - kAngleTolerance_rad &&
                              angle_rad <= joint.upper_rad + kAngleTolerance_rad);
}

}  // namespace

JointData to_joint(const JointElement& element, const urdf::Joint& joint,
                   const Diagnostic& diagnostic) {
  JointData data;
  data.origin = origin_of(*element.xml);
  data.axis = joint_axis(element, diagnostic);
  if (element.type != "fixed") data.kind = AssemblyJoint::Kind::Revolute;
  if (!joint.limits) return data;
  data.effort_n_m = joint.limits->effort;
  if (element.type != "fixed" && joint.limits->velocity == kMotorVelocity) {
    data.kind = AssemblyJoint::Kind::Motor;
  }
  const TiXmlElement& limit = *element.xml->FirstChildElement("limit");
  data.has_range = element.type != "continuous" &&
                   (limit.Attribute("lower") != nullptr || limit.Attribute("upper") != nullptr);
  if (!data.has_range) return data;
  data.lower_rad = joint.limits->lower;
  data.upper_rad = joint.limits->upper;
  if (data.lower_rad > data.upper_rad) {
    diagnostic.at_element(limit, "<limit> lower " + to_text(data.lower_rad) + " is above upper " +
                                     to_text(data.upper_rad));
  }
  return data;
}

void hold(JointData& joint, const JointElement& element, double angle_rad,
          const Diagnostic& diagnostic) {
  if (!joint.axis) diagnostic.at_element(*element.xml, "has no <axis> to turn it about");
  if (!std::isfinite(angle_rad)) {
    diagnostic.at_element(*element.xml, "the angle to hold it at is not finite");
  }
  if (!in_range(joint, angle_rad)) {
    diagnostic.at_element(*element.xml, "cannot be held at " + to_text(angle_rad) +
                                            " rad; allowed: " + to_text(joint.lower_rad) + " to " +
                                            to_text(joint.upper_rad));
  }
  joint.held_at_rad = angle_rad;
}

std::vector<Eigen::Isometry3d> link_poses(const Outline& outline, int chassis,
                                          const std::vector<JointData>& joints) {
  const auto pose_in_urdf_root = [&](int link) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int j = outline.links[at(link)].parent_joint; j >= 0;
         j = outline.links[at(outline.joints[at(j)].parent)].parent_joint) {
      const JointData& joint = joints[at(j)];
      Eigen::Isometry3d step = joint.origin;
      if (joint.held_at_rad) step.rotate(rotation_about(*joint.axis, *joint.held_at_rad));
      pose = step * pose;
    }
    return pose;
  };
  const Eigen::Isometry3d to_chassis = pose_in_urdf_root(chassis).inverse();
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < outline.links.size(); ++i) {
    poses.push_back(to_chassis * pose_in_urdf_root(static_cast<int>(i)));
  }
  return poses;
}

void set_leg_angle(double angle_rad, const Outline& outline, int chassis,
                   std::vector<JointData>& joints, const Diagnostic& diagnostic) {
  if (!std::isfinite(angle_rad)) diagnostic.about_file("the leg angle is not finite");
  const std::vector<Eigen::Isometry3d> poses = link_poses(outline, chassis, joints);
  for (const std::string_view corner : {"fl_", "fr_", "bl_", "br_"}) {
    const std::string name = std::string(corner) + "Leg_joint";
    const int index = index_of(outline.joints, name);
    if (index < 0) {
      diagnostic.about_file("the leg angle cannot be set: there is no joint named " +
                            in_quotes(name));
    }
    const JointElement& element = outline.joints[at(index)];
    JointData& joint = joints[at(index)];
    const Eigen::Isometry3d& leg = poses[at(element.child)];
    const double axis_y = joint.axis ? (leg.linear() * *joint.axis).y() : 0.0;
    if (element.type != "fixed" || std::abs(axis_y) < 1.0 - 1e-9) {
      diagnostic.at_element(
          *element.xml, "the leg angle needs a fixed joint with an <axis> along y of the chassis");
    }
    if (joint.held_at_rad) {
      diagnostic.at_element(*element.xml, "is set both by the leg angle and by its own angle");
    }
    const std::string wheel_name = std::string(corner) + "Wheel";
    const int wheel = index_of(outline.links, wheel_name);
    if (wheel < 0) {
      diagnostic.about_file("the leg angle cannot be set: there is no link named " +
                            in_quotes(wheel_name));
    }
    const Eigen::Vector3d reach = poses[at(wheel)].translation() - leg.translation();
    // A turn about +y moves +x towards -z: it lowers the end of a leg that points forward and lifts
    // one that points back.
    const double now_rad = portable::atan2(-reach.z(), std::abs(reach.x()));
    const double sense = (reach.x() < 0.0 ? -1.0 : 1.0) * (axis_y < 0.0 ? -1.0 : 1.0);
    const double turn_rad = sense * (angle_rad - now_rad);
    if (!in_range(joint, turn_rad)) {
      const auto [lowest, highest] =
          std::minmax({now_rad + sense * joint.lower_rad, now_rad + sense * joint.upper_rad});
      diagnostic.at_element(*element.xml, "a leg angle of " + to_text(angle_rad) +
                                              " rad is out of range; allowed: " + to_text(lowest) +
                                              " to " + to_text(highest));
    }
    joint.held_at_rad = turn_rad;
  }
}

}  // namespace screed::urdf_parts
