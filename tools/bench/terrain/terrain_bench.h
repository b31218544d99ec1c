// The thesis' performance figures 5.6 to 5.9 again: one case is a terrain of one kind and size
// under the driving robot, or a bed of particles that are all awake. Each runs in a process of its
// own, so that its memory can be measured.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace screed::terrain_bench {

/// What runs on the terrain.
enum class Load {
  kRobot,     ///< the robot drives; particles that it does not touch sleep
  kAllAwake,  ///< no robot: particles of a bed that has been shaken, all of them awake
};

struct Case {
  std::string terrain;  ///< as the table calls it
  double size_m;
  /// Under the robot: worlds, a thread each, that share nothing. With all particles awake: threads
  /// that share the work of one bed.
  int threads;
  /// What makes the experiment of this case from the common one: "section.key=value".
  std::vector<std::string> overrides;
  Load load = Load::kRobot;
};

/// All of them, in the order of the table.
std::vector<Case> all_cases();

/// What a case took.
struct Measurement {
  std::uint64_t frames = 0;    ///< of 10 ms of simulated time each: firmware, ten physics steps
  double wall_ms = 0.0;        ///< time by the number of frames of all worlds
  double processor_ms = 0.0;   ///< mean of a frame
  double fastest_ms = 0.0;     ///< shortest time of a frame; with all particles awake alone
  double memory_mb = 0.0;      ///< most that the process ever had resident, 10^6 bytes
  std::uint64_t elements = 0;  ///< heights or particles of a world
  double awake = 0.0;          ///< particles of a world that are computed, mean over the steps
};

/// What the thesis says in words about a frame of that terrain and size, s; most of its results are
/// drawn only.
std::optional<double> thesis_frame_s(const std::string& terrain, double size_m);

/// Writes the common experiment (bed.ini) and its 600 x 600 height map into `folder`.
std::filesystem::path write_bed(const std::filesystem::path& folder);

/// Runs the experiment with these overrides in this process, once in every thread: until the robot
/// drives, then frames are timed, at most so many in a world and for so long.
Measurement measure(const std::filesystem::path& bed, const std::vector<std::string>& overrides,
                    int threads, std::uint64_t max_frames, double longest_s);
/// The particles of the experiment without a robot, woken before any falls asleep.
/// Throws RunError when more than 1 % of them slept.
Measurement measure_all_awake(const std::filesystem::path& bed,
                              const std::vector<std::string>& overrides, int threads,
                              std::uint64_t max_frames, double longest_s);

}  // namespace screed::terrain_bench
