// URDF to Assembly. urdfdom reads the model, but it accepts a good deal that is wrong (a link whose
// inertia it could not read, a cycle beside the tree, a link with two parents), drops the axis of
// fixed joints and names no line: so the XML is checked first, and urdfdom gets what is right.
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/urdf/urdf_body.h"
#include "host_sim/physics/vehicle/urdf/urdf_document.h"
#include "host_sim/physics/vehicle/urdf/urdf_roles.h"
#include "host_sim/physics/vehicle/wheel_rim.h"

namespace screed {

using namespace urdf_parts;

namespace {

constexpr double kMinAxleY = 0.9962;  // cos 5 degrees

// What moves on its own needs mass.
void check_masses(const Assembly& assembly, const Outline& outline, Diagnostic& diagnostic) {
  for (std::size_t i = 0; i < assembly.bodies.size(); ++i) {
    const int link = static_cast<int>(i);
    const int joint = outline.links[i].parent_joint;
    if (joint >= 0 && assembly.joints[at(joint)].kind == AssemblyJoint::Kind::Fixed) continue;
    if (composed_inertia(assembly, rigid_group(assembly, link)).mass > 0.0) continue;
    diagnostic.fault(
        *outline.links[i].xml,
        "needs an <inertial> with a mass, here or on a link fixed to it: it moves on its own");
  }
}

// Its place is constant.
void check_imu(const Assembly& assembly, const Outline& outline, Diagnostic& diagnostic) {
  if (assembly.imu < 0) return;
  const std::vector<int> rigid = rigid_group(assembly, assembly.chassis);
  if (std::find(rigid.begin(), rigid.end(), assembly.imu) != rigid.end()) return;
  diagnostic.fault(*outline.links[at(assembly.imu)].xml,
                   "the IMU must be fixed to the chassis, link " +
                       in_quotes(assembly.bodies[at(assembly.chassis)].name));
}

// What a wheel's link rolls on, in the frame of the chassis. Running gear turns about y.
AssemblyWheel to_wheel(const Assembly& assembly, int link, const Outline& outline,
                       Diagnostic& diagnostic) {
  const AssemblyBody& body = assembly.bodies[at(link)];
  const AssemblyJoint* joint = assembly.joint_to(link);
  if (joint == nullptr) {
    diagnostic.fault(*outline.links[at(link)].xml, "a wheel must be the child of a joint");
    return {};
  }
  // A fixed one has an axis only by chance.
  const Eigen::Vector3d axle = joint->kind == AssemblyJoint::Kind::Fixed
                                   ? Eigen::Vector3d(Eigen::Vector3d::UnitY())
                                   : joint->axis;
  if (std::abs(axle.y()) < kMinAxleY) {
    const JointElement& element = outline.joints[at(outline.links[at(link)].parent_joint)];
    diagnostic.fault(*element.xml, "the axle of wheel " + in_quotes(body.name) +
                                       " is not along y of the chassis, but along " +
                                       to_text(axle.x()) + " " + to_text(axle.y()) + " " +
                                       to_text(axle.z()) +
                                       "; wheels roll straight ahead, up to 5 degrees off");
    return {};
  }
  try {
    const WheelRim rim = wheel_rim(body, body.pose.linear().transpose() * axle);
    const Eigen::Vector3d centre = body.pose.translation() + rim.offset_m * axle;
    return {link, centre, rim.radius_m, rim.width_m, rim.source};
  } catch (const InputError& error) {
    diagnostic.fault(*outline.links[at(link)].xml, std::string("this wheel ") + error.what());
    return {};
  }
}

}  // namespace

Assembly import_urdf(const std::filesystem::path& file, const UrdfOptions& options) {
  Diagnostic diagnostic(file);
  TiXmlDocument xml;
  parse_xml(file, diagnostic, xml);
  const TiXmlElement& robot = *xml.RootElement();
  const Outline outline = read_outline(robot, diagnostic);
  for (const LinkElement& link : outline.links) check_values(*link.xml, diagnostic);
  for (const JointElement& joint : outline.joints) check_values(*joint.xml, diagnostic);
  diagnostic.stop_at_faults();
  check_tree(outline, diagnostic);
  diagnostic.stop_at_faults();
  const urdf::ModelInterfaceSharedPtr model = parse_model(xml, diagnostic);

  std::vector<JointData> joints;
  for (const JointElement& element : outline.joints) {
    joints.push_back(to_joint(element, *model->getJoint(element.name), diagnostic));
  }
  Assembly assembly;
  assembly.name = model->getName();
  for (const LinkElement& element : outline.links) {
    assembly.bodies.push_back(to_body(element, *model->getLink(element.name), file, diagnostic));
  }
  diagnostic.stop_at_faults();
  const int chassis = find_chassis(outline, options, diagnostic);
  const WheelLinks wheels =
      find_wheels(outline, link_poses(outline, chassis, joints), options, diagnostic);
  drive_wheels(outline, wheels, joints);
  for (const auto& [name, angle_rad] : options.joint_angles_rad) {
    const int index = index_of(outline.joints, name);
    if (index < 0) diagnostic.about_file("there is no joint named " + in_quotes(name) + " to hold");
    hold(joints[at(index)], outline.joints[at(index)], angle_rad, diagnostic);
  }
  if (options.leg_angle_rad)
    set_leg_angle(*options.leg_angle_rad, outline, chassis, joints, diagnostic);

  const std::vector<Eigen::Isometry3d> poses = link_poses(outline, chassis, joints);
  for (std::size_t i = 0; i < poses.size(); ++i) assembly.bodies[i].pose = poses[i];
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const JointElement& element = outline.joints[j];
    const JointData& data = joints[j];
    AssemblyJoint joint;
    joint.name = element.name;
    joint.kind = data.held_at_rad ? AssemblyJoint::Kind::Fixed : data.kind;
    joint.parent = element.parent;
    joint.child = element.child;
    joint.pose = poses[at(element.child)];
    if (data.axis) joint.axis = joint.pose.linear() * *data.axis;
    joint.limited = joint.kind == AssemblyJoint::Kind::Revolute && data.has_range;
    joint.lower_rad = data.lower_rad;
    joint.upper_rad = data.upper_rad;
    joint.effort_n_m = data.effort_n_m;
    assembly.joints.push_back(joint);
  }
  check_masses(assembly, outline, diagnostic);
  assembly.chassis = chassis;
  assembly.imu = find_imu(outline, options, diagnostic);
  check_imu(assembly, outline, diagnostic);
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t end = 0; end < 2; ++end) {
      assembly.wheels[side][end] = to_wheel(assembly, wheels[side][end], outline, diagnostic);
    }
  }
  diagnostic.stop_at_faults();
  return assembly;
}

}  // namespace screed
