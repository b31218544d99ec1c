// Numbers, places and colours as text of a POV-Ray scene. Knows nothing of what is drawn.
//
// Scenes here have the world's axes: x east, y north, z up, metres. POV-Ray's own are left-handed
// with y up; a camera with a mirrored `right` vector makes up for that (camera_text() in
// scene_camera.h).
#pragma once

#include <Eigen/Geometry>
#include <cstdio>
#include <string>

#include "host_sim/render/picture/color_map.h"

namespace screed {

/// printf into a string of any length.
template <class... Values>
std::string pov_line(const char* pattern, Values... values) {
  const int length = std::snprintf(nullptr, 0, pattern, values...);
  std::string text(static_cast<size_t>(length), '\0');
  std::snprintf(text.data(), text.size() + 1, pattern, values...);
  return text;
}

/// `<x,y,z>`, to 0.01 mm where the numbers are metres.
inline std::string pov_vector(const Eigen::Vector3d& v) {
  return pov_line("<%.5f,%.5f,%.5f>", v.x(), v.y(), v.z());
}

/// ` matrix <...>`: what stands behind it is placed by `pose`. POV-Ray multiplies rows from the
/// left.
inline std::string pov_matrix(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d& r = pose.linear();
  const Eigen::Vector3d at = pose.translation();
  return pov_line(" matrix <%.7f,%.7f,%.7f, %.7f,%.7f,%.7f, %.7f,%.7f,%.7f, %.6f,%.6f,%.6f>",
                  r(0, 0), r(1, 0), r(2, 0), r(0, 1), r(1, 1), r(2, 1), r(0, 2), r(1, 2), r(2, 2),
                  at.x(), at.y(), at.z());
}

inline std::string pov_color(const Color& color) {
  return pov_line("srgb <%.4f,%.4f,%.4f>", color.red, color.green, color.blue);
}

}  // namespace screed
