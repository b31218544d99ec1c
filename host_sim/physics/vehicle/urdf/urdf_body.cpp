// Triangle meshes from OBJ, STL and Collada files: Assimp reads, this file welds vertices and
// refuses what is no mesh.
#include "host_sim/physics/vehicle/urdf/urdf_body.h"

#include <assimp/config.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <map>
#include <string>
#include <string_view>

#include "host_sim/core/errors.h"

namespace screed {

namespace {

std::string lower_case_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// Assimp shares vertices only where normals agree too, so the corners of a cube come thrice: weld
// by position alone.
class Welder {
 public:
  explicit Welder(TriangleMesh& mesh) : mesh_(mesh) {}

  int index_of(const Eigen::Vector3d& vertex) {
    const auto [entry, is_new] = indices_.try_emplace({vertex.x(), vertex.y(), vertex.z()},
                                                      static_cast<int>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(vertex);
    return entry->second;
  }

 private:
  TriangleMesh& mesh_;
  std::map<std::array<double, 3>, int> indices_;
};

bool has_area(const TriangleMesh& mesh, const std::array<int, 3>& corners) {
  const auto vertex = [&](std::size_t i) -> const Eigen::Vector3d& {
    return mesh.vertices[static_cast<std::size_t>(corners[i])];
  };
  return (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)).squaredNorm() > 0.0;
}

void add_part(const aiMesh& part, const aiMatrix4x4& frame, const Eigen::Vector3d& scale,
              const std::string& where, TriangleMesh& mesh, Welder& welder) {
  for (unsigned int f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices != 3) continue;  // a loose point or line
    std::array<int, 3> corners{};
    for (unsigned int k = 0; k < 3; ++k) {
      const aiVector3D v = frame * part.mVertices[face.mIndices[k]];
      const Eigen::Vector3d vertex =
          Eigen::Vector3f(v.x, v.y, v.z).cast<double>().cwiseProduct(scale);
      if (!vertex.allFinite()) {
        throw InputError(where + ": a vertex is not finite");
      }
      corners[k] = welder.index_of(vertex);
    }
    if (has_area(mesh, corners)) mesh.triangles.push_back(corners);
  }
}

/// The parts of a node and those below it, which have their frames in it.
void add_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent,
              const Eigen::Vector3d& scale, const std::string& where, TriangleMesh& mesh,
              Welder& welder) {
  const aiMatrix4x4 frame = parent * node.mTransformation;
  for (unsigned int m = 0; m < node.mNumMeshes; ++m) {
    add_part(*scene.mMeshes[node.mMeshes[m]], frame, scale, where, mesh, welder);
  }
  for (unsigned int c = 0; c < node.mNumChildren; ++c) {
    add_node(scene, *node.mChildren[c], frame, scale, where, mesh, welder);
  }
}

}  // namespace

TriangleMesh load_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale) {
  const std::string where = "mesh file '" + file.string() + "'";
  const std::string extension = lower_case_extension(file);
  if (extension != ".obj" && extension != ".stl" && extension != ".dae") {
    throw InputError(where + ": this format is not supported; allowed: .obj, .stl, .dae");
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw InputError(where + " does not exist or is not a file");
  }
  Assimp::Importer importer;
  // The axes of a mesh are those of its link, whatever a Collada file calls up: ROS's rule.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (scene == nullptr) {
    throw InputError(where + " cannot be read: " + importer.GetErrorString());
  }

  TriangleMesh mesh;
  Welder welder(mesh);
  add_node(*scene, *scene->mRootNode, aiMatrix4x4(), scale, where, mesh, welder);
  if (mesh.triangles.empty()) throw InputError(where + " contains no triangle");
  return mesh;
}

}  // namespace screed

// Shapes, mass and inertia of a link.

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
  std::string searched;
  for (int up = 0; up <= kFoldersUp; ++up) {
    for (const std::filesystem::path& place : {folder / name, folder / package / name}) {
      if (std::filesystem::is_regular_file(place, error)) return place;
    }
    searched += (up == 0 ? "" : ", ") + folder.string();
    if (folder == folder.parent_path()) break;
    folder = folder.parent_path();
  }
  throw InputError("mesh of package '" + package + "' is not found: neither " + name + " nor " +
                   package + "/" + name + " is in " + searched);
}

Shape to_shape(const TiXmlElement& xml, const urdf::Geometry& geometry,
               const std::filesystem::path& urdf_file, const LinkElement& link,
               Diagnostic& diagnostic) {
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
      diagnostic.fault(*link.xml, error.what());
    }
  }
  return shape;
}

// Massless when mass and moments are zero, as exporters write for a mere place.
Inertia to_inertia(const urdf::Inertial& inertial, const LinkElement& link,
                   Diagnostic& diagnostic) {
  Inertia inertia;
  inertia.mass = inertial.mass;
  inertia.pose = origin_of(*link.xml->FirstChildElement("inertial"));
  inertia.tensor << inertial.ixx, inertial.ixy, inertial.ixz,  //
      inertial.ixy, inertial.iyy, inertial.iyz,                //
      inertial.ixz, inertial.iyz, inertial.izz;
  if (inertia.mass == 0.0 && inertia.tensor.isZero(0.0)) return Inertia{};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia.tensor,
                                                              Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& moments = solver.eigenvalues();  // ascending
  const TiXmlElement& element =
      *link.xml->FirstChildElement("inertial")->FirstChildElement("inertia");
  const std::string values = "principal moments " + to_text(moments[0]) + ", " +
                             to_text(moments[1]) + ", " + to_text(moments[2]) + " kg m^2";
  if (!(moments[0] > 0.0)) {
    diagnostic.fault(element, "<inertia> is not positive definite (" + values + ")");
    return inertia;
  }
  if (moments[2] > (moments[0] + moments[1]) * (1.0 + kRelativeInertiaTolerance)) {
    diagnostic.fault(
        element,
        "<inertia> breaks the triangle inequality, the greatest moment exceeds the sum "
        "of the others (" +
            values + ")");
  }
  return inertia;
}

}  // namespace

AssemblyBody to_body(const LinkElement& element, const urdf::Link& link,
                     const std::filesystem::path& urdf_file, Diagnostic& diagnostic) {
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
