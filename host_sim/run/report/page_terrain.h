// The terrain of a recorded run for its page: the maps over time, and figures of them.
#pragma once

#include <cstdint>
#include <span>

#include "host_sim/core/json.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/render/report/page_file.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {

/// Adds the blocks "terrain-start" and "terrain-steps" to the page, and "terrain-<curve>" of the
/// figures, and returns what the page needs to know of them; null when the session lacks the
/// terrain before the run. `stops`: rows of the session, ascending, at which the page can stop.
Json add_terrain(PageFile& page, const SessionReader& session, std::span<const std::uint64_t> stops,
                 const TaskProgress& progress);

}  // namespace screed
