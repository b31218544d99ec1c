// Triangle meshes from OBJ, STL and Collada files: Assimp reads, this file welds vertices and
// refuses what is no mesh.
#include "host_sim/physics/vehicle/urdf/mesh_loader.h"

#include <assimp/config.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <map>
#include <string>

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
