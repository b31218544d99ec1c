// A recorded run as an MCAP file, for viewers that know nothing of Screed: Foxglove, Lichtblick,
// PlotJuggler. docs/looking-at-runs.md lists its topics.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "host_sim/core/task_progress.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {

struct RunMcapOptions {
  /// Rows of the session; none: all.
  std::optional<FrameRange> range;
  std::uint64_t terrain_every = 500;  ///< ticks from one terrain to the next
  std::optional<Assembly> robot;      ///< without one there are frames of robots, and no bodies
  std::string summary;                ///< summary.json of the run, attached; empty: none
  TaskProgress progress;              ///< of the task "exporting the run"
};

/// Writes every frame, sample and output of a run's robots, at least one, their poses and bodies,
/// the terrain, the leveling curve, events, and what the run was made of. The terrain is that of
/// the first one's session. The same sessions and options give the same bytes. Keys of the radio
/// are not in it. The file appears only when it is complete, and replaces one of the same name.
/// Throws RunError when it cannot be written, InputError when a session is damaged.
void export_mcap(std::span<const SessionReader> sessions, const std::filesystem::path& mcap,
                 const RunMcapOptions& options);

}  // namespace screed
