// How true a stand-in for the physics stays: from a recorded moment on it drives by itself, and
// after some way its robot is compared with the recorded one.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "nn/surrogate/surrogate_plant.h"

namespace screed::nn {

enum class RolloutDrive : std::uint8_t {
  kFirmware,  ///< the firmware drives, from the state it had; it feels the stand-in's motion
  kTracks,    ///< the tracks turn as they were recorded; nobody steers against an error
};

/// Ways after which robots are compared, m.
inline constexpr std::array<double, 3> kRolloutWays_m = {1.0, 5.0, 10.0};

/// A stand-in by its name. A rollout makes a new robot of it at each start.
struct StandIn {
  std::string name;
  std::function<Surrogate()> robot;
};

struct RolloutCheck {
  bool reached = false;      ///< the recording went on so far
  bool straight = false;     ///< no turn was wanted on all of the way
  double place_error = 0.0;  ///< share of the way
  double heading_error_rad = 0.0;
};

struct Rollout {
  std::uint64_t start = 0;  ///< row of the session
  std::array<RolloutCheck, kRolloutWays_m.size()> checks;
  std::vector<PlanarPose> path;  ///< ten a second, places as travelled
  /// Standard deviations of the rate of turn until the last of the ways, or the end.
  double wags_rad_per_s = 0.0;
  double real_wags_rad_per_s = 0.0;
};

struct SessionRollouts {
  std::string source;
  std::vector<std::vector<Rollout>> by_stand_in;  ///< in their order; the same starts
  std::vector<std::vector<PlanarPose>> real;      ///< the recorded paths of these starts
};

struct RolloutOptions {
  RolloutDrive drive = RolloutDrive::kFirmware;
  /// Spread evenly over what Algorithm 5 drove. 0: each begins where the one before has made the
  /// last of the ways, so that no frame is driven twice.
  std::size_t starts = 0;
  std::uint64_t most_frames = 40000;  ///< of a rollout: 400 s, more than 10 m take
  /// The ground gives way below the tracks, by this network; null: it stays as it was at the start.
  /// Of RolloutDrive::kFirmware alone.
  std::shared_ptr<const BearingNetwork> bearing;
};

/// Throws InputError for a session that cannot be followed (nn/surrogate/motion_series.h), and when
/// ground is to give way below tracks that nobody drives.
SessionRollouts roll_out(const std::filesystem::path& session_folder,
                         const std::vector<StandIn>& stand_ins, const RolloutOptions& options);

/// How far two recordings of Algorithm 5 are apart after each of the ways, the first one's as the
/// measure: physics beside physics that began a little elsewhere. Both begin where their drive
/// does.
Rollout apart(const std::filesystem::path& session_folder, const std::filesystem::path& other);

}  // namespace screed::nn
