// Opening and comparing their lengths.
#include "host_sim/run/session/robot_sessions.h"

#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/run/session/run_folder.h"

namespace screed {

namespace {

/// A flash image needs some milliseconds to start: the native robots beside it make a tick or two
/// more.
bool may_belong_together(const SessionReader& first, const SessionReader& further) {
  if (first.frames() == further.frames()) return true;
  return first.complete() && further.complete() && first.frames() < further.frames();
}

}  // namespace

std::vector<SessionReader> open_robots(const std::filesystem::path& run) {
  const std::vector<std::filesystem::path> files = session_files(run);
  std::vector<SessionReader> sessions(files.begin(), files.end());
  for (std::size_t i = 1; i < sessions.size(); ++i) {
    if (may_belong_together(sessions[0], sessions[i])) continue;
    throw InputError(files[i].string() + " has " + std::to_string(sessions[i].frames()) +
                     " frames, " + files[0].string() + " " + std::to_string(sessions[0].frames()) +
                     "; name the session.h5 of one robot instead of the folder");
  }
  return sessions;
}

}  // namespace screed
