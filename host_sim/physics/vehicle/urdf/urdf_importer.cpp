// URDF to Assembly. urdfdom reads the model, but it accepts a good deal that is wrong (a link whose
// inertia it could not read, a cycle beside the tree, a link with two parents), drops the axis of
// fixed joints and names no line: so the XML is checked first, and urdfdom gets what is right.
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"

#include <vector>

#include "host_sim/physics/vehicle/urdf/urdf_body.h"
#include "host_sim/physics/vehicle/urdf/urdf_document.h"
#include "host_sim/physics/vehicle/urdf/urdf_joint.h"
#include "host_sim/physics/vehicle/urdf/urdf_model.h"

namespace screed {

using namespace urdf_parts;  // NOLINT(google-build-using-namespace)

namespace {

// What moves on its own needs mass.
void check_masses(const Assembly& assembly, const Outline& outline, const Diagnostic& diagnostic) {
  for (std::size_t i = 0; i < assembly.bodies.size(); ++i) {
    const int link = static_cast<int>(i);
    const int joint = outline.links[i].parent_joint;
    if (joint >= 0 && assembly.joints[at(joint)].kind == AssemblyJoint::Kind::Fixed) continue;
    if (composed_inertia(assembly, rigid_group(assembly, link)).mass > 0.0) continue;
    diagnostic.at_element(
        *outline.links[i].xml,
        "needs an <inertial> with a mass, here or on a link fixed to it: it moves on its own");
  }
}

}  // namespace

Assembly import_urdf(const std::filesystem::path& file, const UrdfOptions& options) {
  const Diagnostic diagnostic(file);
  TiXmlDocument xml;
  parse_xml(file, diagnostic, xml);
  const TiXmlElement& robot = *xml.RootElement();
  const Outline outline = read_outline(robot, diagnostic);
  check_tree(outline, diagnostic);
  for (const LinkElement& link : outline.links) check_values(*link.xml, diagnostic);
  for (const JointElement& joint : outline.joints) check_values(*joint.xml, diagnostic);
  const urdf::ModelInterfaceSharedPtr model = parse_model(xml, diagnostic);

  std::vector<JointData> joints;
  for (const JointElement& element : outline.joints) {
    joints.push_back(to_joint(element, *model->getJoint(element.name), diagnostic));
  }
  for (const auto& [name, angle_rad] : options.joint_angles_rad) {
    const int index = index_of(outline.joints, name);
    if (index < 0) diagnostic.about_file("there is no joint named " + in_quotes(name) + " to hold");
    hold(joints[at(index)], outline.joints[at(index)], angle_rad, diagnostic);
  }
  if (options.leg_angle_rad) set_leg_angle(*options.leg_angle_rad, outline, joints, diagnostic);

  Assembly assembly;
  assembly.name = model->getName();
  const std::vector<Eigen::Isometry3d> poses = link_poses(outline, joints);
  for (std::size_t i = 0; i < outline.links.size(); ++i) {
    const LinkElement& element = outline.links[i];
    assembly.bodies.push_back(to_body(element, *model->getLink(element.name), file, diagnostic));
    assembly.bodies.back().pose = poses[i];
  }
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
  return assembly;
}

}  // namespace screed
