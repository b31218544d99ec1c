// The frames of a session as a table that every program reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "host_sim/core/record.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/leveling/leveling_point.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {

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

}  // namespace screed
