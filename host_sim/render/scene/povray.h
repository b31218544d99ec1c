// POV-Ray: numbers, places and colours as text of its scenes, and the ray tracer itself, where it
// is installed.
//
// Scenes here have the world's axes: x east, y north, z up, metres. POV-Ray's own are left-handed
// with y up; a camera with a mirrored `right` vector makes up for that (camera_text() in
// scene_camera.h).
#pragma once

#include <Eigen/Geometry>
#include <cstdio>
#include <filesystem>
#include <string>

#include "host_sim/core/task_progress.h"
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

/// Throws InputError unless the name ends in .png or .jpg.
void check_picture_name(const std::filesystem::path& picture);

/// A picture in the making, of which whole files only are left: a scene, the files it names, and
/// what POV-Ray makes of it. All stand in a folder of their own beside the picture until publish()
/// moves them to their places together; a failure before that leaves nothing.
class PovrayJob {
 public:
  /// `picture`: where the picture is to stand, .png or .jpg. Throws InputError for another
  /// extension, RunError when nothing can be written there.
  explicit PovrayJob(std::filesystem::path picture);
  PovrayJob(const PovrayJob&) = delete;
  PovrayJob& operator=(const PovrayJob&) = delete;
  ~PovrayJob();

  /// Where the scene will stand: beside the picture, with the extension .pov.
  std::filesystem::path scene() const;
  /// The name of a file that the scene needs: that of the picture, with this ending in place of its
  /// extension. It will stand beside the scene.
  std::string name_with(const std::string& ending) const;
  /// The place to write a file of that name to now.
  std::filesystem::path in_the_making(const std::string& name) const { return folder_ / name; }

  /// Throws RunError when it cannot be written completely.
  void write_scene(const std::string& text);
  /// False when there is no povray on the path. Throws RunError when it fails, InputError unless
  /// both sides are 16..8000 pixels. Reports the task "rendering PICTURE" several times a second;
  /// POV-Ray ends with what `progress` throws.
  bool render(int width_px, int height_px, const TaskProgress& progress = {});
  /// Moves everything to its place, over files of the same name. Throws RunError.
  void publish();

 private:
  std::filesystem::path picture_;
  std::filesystem::path folder_;
};

}  // namespace screed
