// How far a surrogate of the physics diverges: from a recorded moment on it drives by itself, and
// after some distance its robot is compared with the recorded one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/core/task_progress.h"
#include "nn/surrogate/rollout_checker.h"
#include "nn/surrogate/surrogate_plant.h"

namespace screed::nn {

enum class RolloutDrive : std::uint8_t {
  kFirmware,  ///< the firmware drives, from the state it had; its sensors measure the surrogate's
              ///< motion
  kTracks,    ///< the tracks turn as they were recorded; no controller corrects an error
};

/// A surrogate by its name. A rollout makes a new robot of it at each start. Without `robot`: the
/// stand-in (host_sim/standin), on a ground that it changes.
struct SurrogateFactory {
  std::string name;
  std::function<Surrogate()> robot;
};

struct SessionRollouts {
  std::string source;
  std::vector<std::vector<Rollout>> by_surrogate;  ///< in their order; the same starts
  std::vector<PlanarPose> starts;                  ///< the recorded poses there
  std::vector<std::vector<PlanarPose>> real;       ///< the recorded paths behind these starts
};

struct RolloutOptions {
  RolloutDrive drive = RolloutDrive::kFirmware;
  /// Spread evenly over what Algorithm 5 drove. 0: each begins where the one before has travelled
  /// the last of the distances, so that no frame is driven twice.
  std::size_t starts = 0;
  std::uint64_t max_frames = 40000;  ///< of a rollout: 400 s, more than 10 m take
  /// Of the task "rolling out" over a session, after every rollout; may be empty.
  TaskProgress progress;
};

/// The stand-in changes its ground; below what else is rolled out it stays as it was at the start.
/// Throws InputError for a session that cannot be followed (nn/surrogate/motion_series.h).
SessionRollouts roll_out(const std::filesystem::path& session_folder,
                         const std::vector<SurrogateFactory>& surrogates,
                         const RolloutOptions& options);

/// How far two recordings of Algorithm 5 have diverged after each of the distances, the first one's
/// as the reference: physics beside physics that began a little elsewhere. Both begin where their
/// drive does.
Rollout divergence(const std::filesystem::path& session_folder, const std::filesystem::path& other);

}  // namespace screed::nn
