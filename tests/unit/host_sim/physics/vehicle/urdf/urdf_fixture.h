// What the tests of the URDF importer share: files made from a small one, errors as text, parts by
// name. Files are found from the project's root, where the tests run.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <filesystem>
#include <numbers>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "tests/temp_folder.h"

namespace screed::urdf {

inline const std::string kSmall = "tests/data/urdf/small.urdf";
inline constexpr double kPi = std::numbers::pi;

// One folder for all tests of this process, gone when it ends.
class ModelFolder : public TempFolder {
 public:
  ModelFolder() {
    std::filesystem::copy_file("tests/data/urdf/unit_cube.obj", path() / "unit_cube.obj");
  }
};

inline std::string written_file() {
  static const ModelFolder folder;
  return folder.path() / "robot.urdf";
}

inline std::string write(const std::string& text) {
  write_text(written_file(), text);
  return written_file();
}

// The first `from` in small.urdf becomes `to`.
inline std::string small_with(const std::string& from, const std::string& to) {
  std::string text = read_text(kSmall);
  const std::size_t place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  if (place != std::string::npos) text.replace(place, from.size(), to);
  return text;
}

inline std::string error_of_file(const std::string& file, const UrdfOptions& options = {}) {
  try {
    import_urdf(file, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

inline std::string error_of(const std::string& text) {
  return error_of_file(write(text));
}

inline const AssemblyBody& body(const Assembly& assembly, const std::string& name) {
  return assembly.bodies.at(static_cast<std::size_t>(assembly.body_index(name)));
}

inline const AssemblyJoint& joint(const Assembly& assembly, const std::string& name) {
  return assembly.joints.at(static_cast<std::size_t>(assembly.joint_index(name)));
}

inline Eigen::Matrix3d box_tensor(double mass, const Eigen::Vector3d& size) {
  const Eigen::Vector3d squares = size.cwiseAbs2();
  return (mass / 12.0 * (Eigen::Vector3d::Constant(squares.sum()) - squares)).asDiagonal();
}

}  // namespace screed::urdf
