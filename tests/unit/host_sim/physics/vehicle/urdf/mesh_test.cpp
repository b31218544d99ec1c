// Meshes: OBJ and both kinds of STL give the same unit cube; what is no mesh is refused in one
// line. Files are found from the project's root, where the tests run.
#include "host_sim/physics/vehicle/urdf/mesh_loader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "host_sim/core/errors.h"
#include "tests/ros_robot.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

const std::filesystem::path kData = "tests/data/urdf";

// Divergence theorem: the signed volume of tetrahedra over the origin. Right only if every triangle
// faces outwards.
double volume(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto& v = mesh.vertices;
    const auto corner = [&](std::size_t i) { return v[static_cast<std::size_t>(t[i])]; };
    sum += corner(0).dot(corner(1).cross(corner(2))) / 6.0;
  }
  return sum;
}

std::string error_of(const std::filesystem::path& file) {
  try {
    load_mesh(file, Eigen::Vector3d::Ones());
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

class UnitCube : public ::testing::TestWithParam<const char*> {};

TEST_P(UnitCube, HasEightVerticesTwelveTrianglesAndItsVolume) {
  const TriangleMesh mesh = load_mesh(kData / GetParam(), Eigen::Vector3d::Ones());
  EXPECT_EQ(mesh.vertices.size(), 8U);
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_NEAR(volume(mesh), 1.0, 1e-12);
}

TEST_P(UnitCube, IsScaledAxisByAxis) {
  const TriangleMesh mesh = load_mesh(kData / GetParam(), Eigen::Vector3d(2.0, 3.0, 0.5));
  Eigen::Vector3d greatest = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& v : mesh.vertices) greatest = greatest.cwiseMax(v);
  EXPECT_TRUE(greatest.isApprox(Eigen::Vector3d(2.0, 3.0, 0.5)));
  EXPECT_NEAR(volume(mesh), 3.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Formats, UnitCube,
                         ::testing::Values("unit_cube.obj", "unit_cube.stl",
                                           "unit_cube_binary.stl"));

// In the file's unit and with its nodes' frames; "up" is that of the link.
TEST(Mesh, ColladaIsInMetresAndKeepsItsAxes) {
  const TempFolder folder;
  write_text(folder.path() / "square.dae", testing::square_dae());
  const TriangleMesh mesh = load_mesh(folder.path() / "square.dae", Eigen::Vector3d::Ones());
  ASSERT_EQ(mesh.vertices.size(), 4U);
  EXPECT_EQ(mesh.triangles.size(), 2U);
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    EXPECT_NEAR(std::abs(vertex.x()), 0.001, 1e-9);
    EXPECT_NEAR(std::abs(vertex.y()), 0.001, 1e-9);
    EXPECT_NEAR(vertex.z(), 0.005, 1e-9);
  }
}

TEST(Mesh, MissingFileIsNamed) {
  EXPECT_EQ(error_of("tests/data/urdf/gone.stl"),
            "mesh file 'tests/data/urdf/gone.stl' does not exist or is not a file");
}

TEST(Mesh, OtherFormatIsRefusedWithTheAllowedOnes) {
  EXPECT_EQ(error_of("robot.ply"),
            "mesh file 'robot.ply': this format is not supported; allowed: .obj, .stl, .dae");
}

TEST(Mesh, EmptyFileIsRefused) {
  EXPECT_NE(error_of(kData / "empty.obj").find("empty.obj' cannot be read"), std::string::npos)
      << error_of(kData / "empty.obj");
}

TEST(Mesh, VerticesWithoutTrianglesAreRefused) {
  EXPECT_NE(error_of(kData / "points_only.obj").find("points_only.obj'"), std::string::npos)
      << error_of(kData / "points_only.obj");
}

TEST(Mesh, TrianglesWithoutAreaAreNoMesh) {
  const std::filesystem::path file = kData / "no_area.obj";
  EXPECT_NE(error_of(file).find("contains no triangle"), std::string::npos) << error_of(file);
}

TEST(Mesh, NotFiniteVertexIsRefused) {
  EXPECT_NE(error_of(kData / "not_finite.obj").find("a vertex is not finite"), std::string::npos)
      << error_of(kData / "not_finite.obj");
}

TEST(Mesh, TruncatedBinaryStlIsRefused) {
  const std::filesystem::path file = kData / "truncated_binary.stl";
  EXPECT_NE(error_of(file).find("cannot be read"), std::string::npos) << error_of(file);
}

}  // namespace
}  // namespace screed
