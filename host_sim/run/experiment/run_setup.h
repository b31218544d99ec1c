// What is shown of a recorded run beside its numbers: robot, terrain, algorithm, out of the
// experiment that was in force. Reads sessions of older programs too.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "host_sim/core/ini_file.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/session_layout.h"

namespace screed {

/// Whether an entry of an experiment is a key of the radio, and what stands for it where an
/// experiment is shown.
bool is_secret(const IniEntry& entry);
inline constexpr const char* kSecretText = "(not shown)";

struct RunSetup {
  /// Only the vehicle's keys that find and shape the model, the model of the map and the radius of
  /// its particles, the algorithm, what is flat, and the folder.
  Experiment experiment;
  std::string soil;  ///< [soil] preset
};

/// `folder`: where the run lies; files of its own are looked for there first.
RunSetup setup_of(const SessionInfo& info, const std::filesystem::path& folder);

/// The run's robot, or the one of the file. A model that the experiment named by a file is looked
/// for in the run's folder, in those above it and in the current one. Throws InputError.
Assembly robot_model(const RunSetup& setup, const std::string& board,
                     const std::optional<std::filesystem::path>& file = std::nullopt);

}  // namespace screed
