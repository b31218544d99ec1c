// Replays a recorded run through the firmware core: the same samples must give the same output
// bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "firmware/parameters/parameters.h"
#include "hal/sample.h"
#include "host_sim/core/task_progress.h"

namespace screed {

struct ReplayResult {
  std::uint64_t ticks = 0;  ///< ticks replayed: all of them, also behind a difference
  std::optional<std::uint64_t> first_difference_tick;  ///< counted from 0
  std::string
      first_difference;     ///< "duty_left: expected 12, got 15"; expected is what was recorded
  std::string arithmetic;   ///< of the recorded world (session_layout.h)
  std::string output_hash;  ///< hash of the replayed outputs, 32 hexadecimal digits
  bool complete =
      true;  ///< false when the recorded run was killed: only its saved part was replayed
  bool running = false;  ///< it was still being recorded
  bool unchanged =
      true;  ///< false when the file's content no longer has the hash it was saved with
};

class Robot;
class SessionReader;

struct ReplayOptions {
  /// In place of the recorded ones: what would the robot have answered?
  std::optional<Parameters> parameters;
  /// Told of each tick: its number, the recorded and the replayed output, the robot after it.
  std::function<void(std::uint64_t tick, const RobotOutput& recorded, const RobotOutput& replayed,
                     const Robot& robot)>
      on_tick;
  TaskProgress progress;  ///< of the task "replaying"
};

/// Throws InputError, with the file's name, when no robot of this program can be fed the session:
/// it has no tick, a board constant of 0, or was recorded at another tick rate.
void check_replayable(const SessionReader& session, const std::filesystem::path& session_file);

/// Builds a Robot from the recorded parameters and board constants, feeds it the recorded samples
/// and compares its outputs byte for byte, of the radio only the valid bytes. Throws InputError
/// when the file is no session, or as check_replayable().
ReplayResult replay_session(const std::filesystem::path& session_file,
                            const ReplayOptions& options = {});

}  // namespace screed
