// The sessions of a run with several robots, opened together.
#pragma once

#include <filesystem>
#include <vector>

#include "host_sim/run/session/session_reader.h"

namespace screed {

/// Of the robots of a run as session_files() lists them, at least one. Beside a flash image, which
/// is the first, robots may have made a tick or two more than it: a row of the first one's is then
/// up to 10 ms later than theirs. Throws InputError as SessionReader does, and when they have not
/// the same ticks otherwise, which happens in a run that was killed.
std::vector<SessionReader> open_robots(const std::filesystem::path& run);

}  // namespace screed
