// The recorded height map of a session as images: a 16-bit PNG series to compute with, pictures to
// look at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/core/task_progress.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/render/picture/robot_shape.h"
#include "host_sim/run/session/csv_export.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {

/// The same heights as a field. Throws InputError for a map that no field can hold.
HeightField field_of(const HeightMap& map);

/// What the samples of an exported series mean: height = black + sample * (white - black) / 65535.
struct HeightScale {
  double black_m = 0.0;
  double white_m = 0.0;
};

struct HeightExport {
  HeightScale scale;                         ///< one for the whole series
  std::vector<std::filesystem::path> files;  ///< the images, one a frame
};

/// How pictures of a session are drawn.
struct PictureSeries {
  std::vector<std::string> state_names;  ///< of the leveling algorithm's states, by number
  std::optional<RobotShape> shape;       ///< without one the path's end stands for the robot
  /// The surface that is drawn of a terrain; empty: the terrain.
  std::function<HeightField(const HeightField&)> surface;
};

/// Writes frames first, first + every, ... of `range` as folder/height_NNNNNN.png (NNNNNN: the row
/// of the frame in the session; top row north), and folder/scale.json, which says what a sample is
/// in metres and where it lies. The folder must exist. Throws InputError when the session has no
/// recorded heights or the range is empty, RunError when a file cannot be written. Reports the task
/// "exporting heights". The files appear together, at the end, or not at all.
HeightExport export_heights_png(const SessionReader& session, const FrameRange& range,
                                std::uint64_t every, const std::filesystem::path& folder,
                                const TaskProgress& progress = {});

/// Writes the same frames as shaded pictures with the robots and their paths,
/// folder/picture_NNNNNN.png, in the same way. `sessions`: of all robots, the one with the heights
/// first. Reports the task "exporting pictures".
std::vector<std::filesystem::path> export_pictures(std::span<const SessionReader> sessions,
                                                   const FrameRange& range, std::uint64_t every,
                                                   const std::filesystem::path& folder,
                                                   const PictureSeries& series,
                                                   const TaskProgress& progress = {});

}  // namespace screed
