// A recorded run as one HTML page: terrain over time, driven path, curves, figures, configuration.
// What the page does with it is in tools/report.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "host_sim/core/task_progress.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {

struct RunPageOptions {
  std::filesystem::path built_page;  ///< page.html of the build
  std::string name;                  ///< of the run, in the title
  std::optional<Assembly> robot;     ///< without one a small marker stands for the robot
  TaskProgress progress;             ///< of the task "reading the run"
};

/// The page of a run's robots, at least one, with the same ticks; the terrain is that of the first
/// one's session. The same sessions and options give the same bytes. Keys of the radio are not on
/// it. Throws InputError when the run has no tick or is damaged, or there is no built page.
std::string run_page(std::span<const SessionReader> sessions, const RunPageOptions& options);

}  // namespace screed
