// Kinds, ranges and angles of joints.
#include "host_sim/physics/vehicle/urdf/urdf_roles.h"

#include <algorithm>
#include <cctype>
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
std::optional<Eigen::Vector3d> joint_axis(const JointElement& joint, Diagnostic& diagnostic) {
  const TiXmlElement* element = joint.xml->FirstChildElement("axis");
  if (element == nullptr) {
    if (joint.type == "fixed") return {};
    return Eigen::Vector3d::UnitX();  // the default of URDF
  }
  const std::vector<double> xyz = parse_numbers(attribute(*element, "xyz"));
  const Eigen::Vector3d axis(xyz[0], xyz[1], xyz[2]);
  // stableNorm: neither overflow nor underflow makes an odd axis look like zero.
  if (axis.stableNorm() == 0.0) {
    // Exporters write this into every fixed joint, where URDF gives it no meaning.
    if (joint.type != "fixed") diagnostic.fault(*element, "<axis> is zero; it needs a direction");
    return {};
  }
  return axis.stableNormalized();
}

bool in_range(const JointData& joint, double angle_rad) {
  return !joint.has_range || (angle_rad >= joint.lower_rad - kAngleTolerance_rad &&
                              angle_rad <= joint.upper_rad + kAngleTolerance_rad);
}

}  // namespace

JointData to_joint(const JointElement& element, const urdf::Joint& joint, Diagnostic& diagnostic) {
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
    diagnostic.fault(limit, "<limit> lower " + to_text(data.lower_rad) + " is above upper " +
                                to_text(data.upper_rad));
  }
  return data;
}

void hold(JointData& joint, const JointElement& element, double angle_rad, Diagnostic& diagnostic) {
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
                   std::vector<JointData>& joints, Diagnostic& diagnostic) {
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

// Roles by name, by the options, by place.

namespace {

constexpr std::array<const char*, 4> kThesisWheels = {"fl_Wheel", "fr_Wheel", "bl_Wheel",
                                                      "br_Wheel"};
constexpr const char* kHowToName =
    "; [vehicle] wheel_links = FRONT_LEFT FRONT_RIGHT REAR_LEFT REAR_RIGHT names the links";
constexpr double kSamePlace_m = 1e-3;

/// Of a link that an option names.
int named_link(const Outline& outline, const std::string& name, const char* key,
               Diagnostic& diagnostic) {
  const int link = index_of(outline.links, name);
  if (link >= 0) return link;
  std::string all;
  for (const LinkElement& other : outline.links) {
    all += all.empty() ? "" : ", ";
    all += other.name;
  }
  diagnostic.about_file(std::string("there is no link named ") + in_quotes(name) + " ([vehicle] " +
                        key + "); the links are " + all);
}

bool has_mass(const LinkElement& link) {
  const TiXmlElement* inertial = link.xml->FirstChildElement("inertial");
  if (inertial == nullptr) return false;
  return parse_numbers(attribute(*inertial->FirstChildElement("mass"), "value"))[0] > 0.0;
}

bool is_fixed_to(const Outline& outline, int link, int ancestor) {
  while (link != ancestor) {
    const int joint = outline.links[at(link)].parent_joint;
    if (joint < 0 || outline.joints[at(joint)].type != "fixed") return false;
    link = outline.joints[at(joint)].parent;
  }
  return true;
}

bool says_wheel(const std::string& name) {
  std::string lower = name;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower.find("wheel") != std::string::npos;
}

/// "'a' (joint 'b')", separated by commas.
std::string list_of(const Outline& outline, const std::vector<int>& links) {
  std::string text;
  for (const int link : links) {
    const LinkElement& element = outline.links[at(link)];
    text += text.empty() ? "" : ", ";
    text += in_quotes(element.name);
    if (element.parent_joint < 0) continue;
    text += " (joint ";
    text += in_quotes(outline.joints[at(element.parent_joint)].name);
    text += ")";
  }
  return text;
}

/// Links of joints that turn without end; of those with "wheel" in their names, or of all.
std::vector<int> turning_links(const Outline& outline, bool only_wheels) {
  std::vector<int> links;
  for (std::size_t i = 0; i < outline.links.size(); ++i) {
    const LinkElement& link = outline.links[i];
    if (link.parent_joint < 0) continue;
    const JointElement& joint = outline.joints[at(link.parent_joint)];
    if (joint.type != "continuous") continue;
    if (only_wheels && !says_wheel(link.name) && !says_wheel(joint.name)) continue;
    links.push_back(static_cast<int>(i));
  }
  return links;
}

std::vector<int> wheels_by_name(const Outline& outline, Diagnostic& diagnostic) {
  std::vector<int> wheels = turning_links(outline, true);
  if (wheels.size() == 4) return wheels;
  std::string found = "a robot needs four wheels; ";
  if (wheels.empty()) {
    const std::vector<int> turning = turning_links(outline, false);
    found += "no link of a continuous joint has \"wheel\" in its name or its joint's (";
    found += turning.empty() ? "there is no continuous joint" : list_of(outline, turning);
    found += ")";
  } else {
    found += "by their names (\"wheel\" in that of a continuous joint or its link) there ";
    found += wheels.size() == 1 ? "is " : "are ";
    found += std::to_string(wheels.size()) + ": " + list_of(outline, wheels);
  }
  diagnostic.about_file(found + kHowToName);
}

/// Four links sorted by where they are.
WheelLinks by_place(const Outline& outline, std::vector<int> wheels,
                    const std::vector<Eigen::Isometry3d>& poses, Diagnostic& diagnostic) {
  const auto y = [&](int link) { return poses[at(link)].translation().y(); };
  const auto x = [&](int link) { return poses[at(link)].translation().x(); };
  std::sort(wheels.begin(), wheels.end(), [&](int a, int b) { return y(a) > y(b); });
  WheelLinks sides = {{{wheels[0], wheels[1]}, {wheels[2], wheels[3]}}};
  if (!(y(wheels[1]) > 0.0 && y(wheels[2]) < 0.0)) {
    diagnostic.about_file(
        "two wheels must be to the left (y > 0) and two to the right of the "
        "chassis; there are " +
        list_of(outline, wheels) + ", from left to right" + kHowToName);
  }
  for (auto& side : sides) {
    if (x(side[0]) < x(side[1])) std::swap(side[0], side[1]);
    if (x(side[0]) - x(side[1]) < kSamePlace_m) {
      diagnostic.about_file("of two wheels of a side one must be in front (x); " +
                            list_of(outline, {side[0], side[1]}) + " are at the same place" +
                            kHowToName);
    }
  }
  return sides;
}

/// Refuses names in another order than that of kHowToName.
void check_places(const Outline& outline, const WheelLinks& wheels,
                  const std::vector<Eigen::Isometry3d>& poses, Diagnostic& diagnostic) {
  const auto place = [&](int link) -> Eigen::Vector3d { return poses[at(link)].translation(); };
  for (const std::size_t end : {0U, 1U}) {
    if (place(wheels[0][end]).y() > place(wheels[1][end]).y()) continue;
    diagnostic.about_file(list_of(outline, {wheels[0][end]}) + " is not to the left (y) of " +
                          list_of(outline, {wheels[1][end]}) + kHowToName);
  }
  for (const auto& side : wheels) {
    if (place(side[0]).x() > place(side[1]).x()) continue;
    diagnostic.about_file(list_of(outline, {side[0]}) + " is not in front (x) of " +
                          list_of(outline, {side[1]}) + kHowToName);
  }
}

}  // namespace

int find_chassis(const Outline& outline, const UrdfOptions& options, Diagnostic& diagnostic) {
  if (!options.chassis_link.empty()) {
    return named_link(outline, options.chassis_link, "chassis_link", diagnostic);
  }
  for (const char* name : {"Body", "base_link"}) {
    if (const int link = index_of(outline.links, name); link >= 0) return link;
  }
  int root = 0;
  while (outline.links[at(root)].parent_joint >= 0) {
    root = outline.joints[at(outline.links[at(root)].parent_joint)].parent;
  }
  for (std::size_t i = 0; i < outline.links.size() && !has_mass(outline.links[at(root)]); ++i) {
    const int link = static_cast<int>(i);
    if (has_mass(outline.links[i]) && is_fixed_to(outline, link, root)) return link;
  }
  return root;
}

WheelLinks find_wheels(const Outline& outline, const std::vector<Eigen::Isometry3d>& poses,
                       const UrdfOptions& options, Diagnostic& diagnostic) {
  WheelLinks wheels{};
  const auto take = [&](const auto& names, const auto& find) {
    for (std::size_t i = 0; i < 4; ++i) wheels[i % 2][i / 2] = find(names[i]);
  };
  if (!options.wheel_links[0].empty()) {
    take(options.wheel_links, [&](const std::string& name) {
      return named_link(outline, name, "wheel_links", diagnostic);
    });
  } else if (std::any_of(kThesisWheels.begin(), kThesisWheels.end(),
                         [&](const char* name) { return index_of(outline.links, name) < 0; })) {
    return by_place(outline, wheels_by_name(outline, diagnostic), poses, diagnostic);
  } else {
    take(kThesisWheels, [&](const char* name) { return index_of(outline.links, name); });
  }
  check_places(outline, wheels, poses, diagnostic);
  return wheels;
}

int find_imu(const Outline& outline, const UrdfOptions& options, Diagnostic& diagnostic) {
  if (!options.imu_link.empty()) {
    return named_link(outline, options.imu_link, "imu_link", diagnostic);
  }
  const int thesis = index_of(outline.links, "Imu");
  return thesis >= 0 ? thesis : index_of(outline.links, "imu_link");
}

void drive_wheels(const Outline& outline, const WheelLinks& wheels,
                  std::vector<JointData>& joints) {
  std::vector<JointData*> without_end;
  for (const auto& side : wheels) {
    for (const int link : side) {
      const int joint = outline.links[at(link)].parent_joint;
      if (joint < 0) continue;
      if (joints[at(joint)].kind == AssemblyJoint::Kind::Motor) return;
      if (outline.joints[at(joint)].type == "continuous") without_end.push_back(&joints[at(joint)]);
    }
  }
  for (JointData* joint : without_end) joint->kind = AssemblyJoint::Kind::Motor;
}

}  // namespace screed::urdf_parts
