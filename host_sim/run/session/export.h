// Tables and heights of a session for other programs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/core/record.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {

// The frames of a session as a table that every program reads.

/// The rows of a session from `first` on, `count` of them.
struct FrameRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;
};

/// Writes one line a frame, all columns of SCREED_FRAME_COLUMNS, first line "time [s],x [m],...".
/// Numbers are the shortest decimal text that reads back to the same bits; a column that an old
/// session lacks is "nan". The file appears only when it is complete, and replaces one of the same
/// name. Throws RunError when it cannot be written.
void export_frames_csv(const SessionReader& session, const std::filesystem::path& csv);

/// The same of the leveling curve: one line a point.
void export_leveling_csv(std::span<const LevelingPoint> points, const std::filesystem::path& csv);

/// The variables of thesis Table 5.1, in its order.
std::span<const Column> table_5_1_columns();

/// The same for these columns and rows, behind a first column "frame": the row's number in the
/// session. Throws std::out_of_range for rows that the session does not have. Reports the task
/// "exporting a table".
void export_columns_csv(const SessionReader& session, std::span<const Column> columns,
                        const FrameRange& range, const std::filesystem::path& csv,
                        const TaskProgress& progress = {});

/// The frames that the training drive drove, from the first to the last; nothing (count 0) when it
/// never ran.
FrameRange training_frames(const SessionReader& session);

// The recorded height map of a session as images: a 16-bit PNG series to compute with, pictures to
// look at.

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
