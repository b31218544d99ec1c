// Bodies of a robot model: meshes, and what a wheel rolls on.
#include <gtest/gtest.h>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/urdf/urdf_body.h"
#include "host_sim/physics/vehicle/wheel_rim.h"
#include "tests/ros_robot.h"
#include "tests/temp_folder.h"

namespace screed {

namespace {

// Meshes: OBJ and both kinds of STL give the same unit cube; what is no mesh is refused in one
// line. Files are found from the project's root, where the tests run.

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

// What a wheel rolls on: cylinders, spheres and meshes about an axle.

const Eigen::Vector3d kAxle = Eigen::Vector3d::UnitY();

/// z of the shape along y of the link, and then moved.
Shape lying(std::variant<Box, Cylinder, Sphere, TriangleMesh> geometry,
            const Eigen::Vector3d& middle = Eigen::Vector3d::Zero()) {
  Shape shape;
  shape.pose.translation() = middle;
  shape.pose.rotate(Eigen::AngleAxisd(-0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()));
  shape.geometry = std::move(geometry);
  return shape;
}

/// A drum about z from `low` to `high`.
TriangleMesh drum(double radius, double low, double high, int corners = 36) {
  TriangleMesh mesh;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), low);
    mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), high);
  }
  return mesh;
}

std::string error_of(const AssemblyBody& wheel) {
  try {
    wheel_rim(wheel, kAxle);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

AssemblyBody with(std::vector<Shape> collision, std::vector<Shape> visual = {}) {
  AssemblyBody body;
  body.collision = std::move(collision);
  body.visual = std::move(visual);
  return body;
}

TEST(WheelRim, ACylinderCountsBeforeOtherShapes) {
  const WheelRim rim =
      wheel_rim(with({lying(Sphere{0.5}), lying(Cylinder{0.1, 0.04}, {0.0, 0.01, 0.0})}), kAxle);
  EXPECT_EQ(rim.radius_m, 0.1);
  EXPECT_EQ(rim.width_m, 0.04);
  EXPECT_NEAR(rim.offset_m, 0.01, 1e-15);
  EXPECT_STREQ(rim.source, "collision cylinder");
  // Along the axle from the other end.
  EXPECT_NEAR(wheel_rim(with({lying(Cylinder{0.1, 0.04}, {0.0, 0.01, 0.0})}), -kAxle).offset_m,
              -0.01, 1e-15);
}

TEST(WheelRim, AMeshIsRoundedUpToACylinderAboutTheAxle) {
  const WheelRim rim = wheel_rim(with({lying(drum(0.08, -0.01, 0.05))}), kAxle);
  EXPECT_NEAR(rim.radius_m, 0.08, 1e-12);
  EXPECT_NEAR(rim.width_m, 0.06, 1e-12);
  EXPECT_NEAR(rim.offset_m, 0.02, 1e-12);
  // All meshes of the wheel together: a tyre and a hub.
  EXPECT_NEAR(
      wheel_rim(with({lying(drum(0.08, -0.01, 0.05)), lying(drum(0.02, -0.03, 0.0))}), kAxle)
          .width_m,
      0.08, 1e-12);
  EXPECT_NEAR(wheel_rim(with({lying(drum(0.08, 0.0, 0.05, 6))}), kAxle).radius_m, 0.08, 1e-12);
}

TEST(WheelRim, ASphereIsAsWideAsItIsDrawn) {
  const Shape sphere = lying(Sphere{0.1});
  EXPECT_EQ(wheel_rim(with({sphere}), kAxle).radius_m, 0.1);
  EXPECT_EQ(wheel_rim(with({sphere}), kAxle).width_m, 0.1);
  EXPECT_STREQ(wheel_rim(with({sphere}), kAxle).source, "collision sphere");
  EXPECT_EQ(wheel_rim(with({sphere}, {lying(Cylinder{0.09, 0.03})}), kAxle).width_m, 0.03);
  EXPECT_NEAR(wheel_rim(with({sphere}, {lying(drum(0.1, -0.02, 0.02))}), kAxle).width_m, 0.04,
              1e-12);
  EXPECT_EQ(wheel_rim(with({sphere}, {lying(Cylinder{0.09, 0.5})}), kAxle).width_m, 0.2)
      << "no wider than the sphere";
}

TEST(WheelRim, WithoutCollisionTheVisualCounts) {
  const WheelRim rim = wheel_rim(with({}, {lying(drum(0.08, -0.01, 0.01))}), kAxle);
  EXPECT_NEAR(rim.radius_m, 0.08, 1e-12);
  EXPECT_STREQ(rim.source, "visual mesh");
  EXPECT_STREQ(wheel_rim(with({}, {lying(Cylinder{0.1, 0.04})}), kAxle).source, "visual cylinder");
}

TEST(WheelRim, WhatCannotRollIsRefused) {
  EXPECT_NE(error_of(with({})).find("has no shape to roll on"), std::string::npos);
  EXPECT_NE(error_of(with({lying(Box{{1.0, 1.0, 1.0}})})).find("has no shape to roll on"),
            std::string::npos);
  Shape upright;
  upright.geometry = Cylinder{0.1, 0.04};
  EXPECT_NE(error_of(with({upright})).find("has a cylinder that lies 90 degrees off the axle"),
            std::string::npos);
  EXPECT_EQ(error_of(with({lying(Cylinder{0.1, 0.04}, {0.02, 0.0, 0.0})})),
            "has a cylinder whose middle is 20.0 mm beside the axle");
  EXPECT_EQ(error_of(with({lying(Sphere{0.1}, {0.0, 0.0, 0.02})})),
            "has a sphere whose middle is 20.0 mm beside the axle");
  EXPECT_NE(error_of(with({lying(drum(0.1, -0.01, 0.01), {0.03, 0.0, 0.0})})).find("has a mesh"),
            std::string::npos);
  EXPECT_EQ(error_of(with({lying(Cylinder{0.1, 0.04}, {0.005, 0.0, 0.0})})), "no error");
}

}  // namespace

}  // namespace screed
