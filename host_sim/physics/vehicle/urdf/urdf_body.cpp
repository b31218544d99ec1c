// Shapes, mass and inertia of a link.
#include "host_sim/physics/vehicle/urdf/urdf_body.h"

#include <Eigen/Eigenvalues>
#include <string>
#include <string_view>

#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/urdf/mesh_loader.h"

namespace screed::urdf_parts {
namespace {

// A thin plate has I1 + I2 = I3 but for the last digits.
constexpr double kRelativeInertiaTolerance = 1e-6;

// Where a mesh of this name lies. "package://robot/meshes/a.obj" is meshes/a.obj beside the URDF
// file or in a folder above it, since a ROS package has its models in a folder of their own.
std::filesystem::path mesh_path(const std::filesystem::path& urdf_file, std::string name) {
  constexpr std::string_view kPackage = "package://";
  constexpr std::string_view kFile = "file://";
  constexpr int kFoldersUp = 4;
  if (name.starts_with(kFile)) return name.substr(kFile.size());
  if (!name.starts_with(kPackage)) return urdf_file.parent_path() / name;
  const std::size_t slash = name.find('/', kPackage.size());
  const std::string package = name.substr(kPackage.size(), slash - kPackage.size());
  name.erase(0, slash == std::string::npos ? kPackage.size() : slash + 1);
  std::error_code error;
  std::filesystem::path folder = std::filesystem::absolute(urdf_file, error).parent_path();
  for (int up = 0; up <= kFoldersUp; ++up) {
    for (const std::filesystem::path& place : {folder / name, folder / package / name}) {
      if (std::filesystem::is_regular_file(place, error)) return place;
    }
    folder = folder.parent_path();
  }
  return urdf_file.parent_path() / name;
}

Shape to_shape(const TiXmlElement& xml, const urdf::Geometry& geometry,
               const std::filesystem::path& urdf_file, const LinkElement& link,
               const Diagnostic& diagnostic) {
  Shape shape;
  shape.pose = origin_of(xml);
  if (geometry.type == urdf::Geometry::BOX) {
    shape.geometry = Box{to_eigen(dynamic_cast<const urdf::Box&>(geometry).dim)};
  } else if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = dynamic_cast<const urdf::Cylinder&>(geometry);
    shape.geometry = Cylinder{cylinder.radius, cylinder.length};
  } else if (geometry.type == urdf::Geometry::SPHERE) {
    shape.geometry = Sphere{dynamic_cast<const urdf::Sphere&>(geometry).radius};
  } else {
    const auto& mesh = dynamic_cast<const urdf::Mesh&>(geometry);
    try {
      shape.geometry = load_mesh(mesh_path(urdf_file, mesh.filename), to_eigen(mesh.scale));
    } catch (const InputError& error) {
      diagnostic.at_element(*link.xml, error.what());
    }
  }
  return shape;
}

Inertia to_inertia(const urdf::Inertial& inertial, const LinkElement& link,
                   const Diagnostic& diagnostic) {
  Inertia inertia;
  inertia.mass = inertial.mass;
  inertia.pose = origin_of(*link.xml->FirstChildElement("inertial"));
  inertia.tensor << inertial.ixx, inertial.ixy, inertial.ixz,  //
      inertial.ixy, inertial.iyy, inertial.iyz,                //
      inertial.ixz, inertial.iyz, inertial.izz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia.tensor,
                                                              Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& moments = solver.eigenvalues();  // ascending
  const TiXmlElement& element =
      *link.xml->FirstChildElement("inertial")->FirstChildElement("inertia");
  const std::string values = "principal moments " + to_text(moments[0]) + ", " +
                             to_text(moments[1]) + ", " + to_text(moments[2]) + " kg m^2";
  if (!(moments[0] > 0.0)) {
    diagnostic.at_element(element, "<inertia> is not positive definite (" + values + ")");
  }
  if (moments[2] > (moments[0] + moments[1]) * (1.0 + kRelativeInertiaTolerance)) {
    diagnostic.at_element(
        element,
        "<inertia> breaks the triangle inequality, the greatest moment exceeds the sum "
        "of the others (" +
            values + ")");
  }
  return inertia;
}

}  // namespace

AssemblyBody to_body(const LinkElement& element, const urdf::Link& link,
                     const std::filesystem::path& urdf_file, const Diagnostic& diagnostic) {
  AssemblyBody body;
  body.name = element.name;
  if (link.inertial) body.inertia = to_inertia(*link.inertial, element, diagnostic);
  const TiXmlElement* xml = element.xml->FirstChildElement("collision");
  for (const urdf::CollisionSharedPtr& item : link.collision_array) {
    body.collision.push_back(to_shape(*xml, *item->geometry, urdf_file, element, diagnostic));
    xml = xml->NextSiblingElement("collision");
  }
  xml = element.xml->FirstChildElement("visual");
  for (const urdf::VisualSharedPtr& item : link.visual_array) {
    body.visual.push_back(to_shape(*xml, *item->geometry, urdf_file, element, diagnostic));
    xml = xml->NextSiblingElement("visual");
  }
  return body;
}

}  // namespace screed::urdf_parts
