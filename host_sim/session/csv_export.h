// The frames of a session as a table that every program reads.
#pragma once

#include <filesystem>

#include "host_sim/session/session_reader.h"

namespace screed {

/// Writes one line a frame, all columns of SCREED_FRAME_COLUMNS, first line "time [s],x [m],...".
/// Numbers are the shortest decimal text that reads back to the same bits; a column that an old
/// session lacks is "nan". The file appears only when it is complete, and replaces one of the same
/// name. Throws RunError when it cannot be written.
void export_frames_csv(const SessionReader& session, const std::filesystem::path& csv);

}  // namespace screed
