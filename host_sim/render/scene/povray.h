// Runs the ray tracer POV-Ray, where it is installed, and leaves whole files only.
#pragma once

#include <filesystem>
#include <string>

#include "host_sim/core/task_progress.h"

namespace screed {

/// Throws InputError unless the name ends in .png or .jpg.
void check_picture_name(const std::filesystem::path& picture);

/// A picture in the making: a scene, the files it names, and what POV-Ray makes of it. All stand in
/// a folder of their own beside the picture until publish() moves them to their places together; a
/// failure before that leaves nothing.
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
