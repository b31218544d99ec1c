// Seeded drives with and without a trap, to train the robot's slip watch and to measure it: what
// they are, and what the watch got in every tick beside the truth. The watch only observes, so a
// recorded drive evaluates any network for it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/task_progress.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/world/world.h"

namespace screed::nn {

/// What a drive is for.
enum class ScenarioKind : std::uint8_t {
  kFree,      ///< no trap, hills of at most 8 degrees: false alarms are counted here
  kTrapped,   ///< meets a trap within the first metre
  kOrdinary,  ///< no trap, the leveling algorithms, on hills of at most 20 degrees or in beds with
              ///< walls
};
inline constexpr ScenarioKind kScenarioKinds[] = {ScenarioKind::kFree, ScenarioKind::kTrapped,
                                                  ScenarioKind::kOrdinary};
/// free, trapped, ordinary
const char* name_of(ScenarioKind kind);

struct StuckScenario {
  Experiment experiment;
  ScenarioKind kind = ScenarioKind::kFree;
  std::string ground;  ///< rigid, or the soil's preset
};

/// A drive of this seed on rigid ground (twice as often) or one of the named soils; its sensors
/// have the noise and the errors of their data sheets. Free and trapped ones go straight on, in
/// arcs or at random (Algorithm 6) at 0.08 to 0.2 m/s; traps are a wall, a slope too steep, a
/// trench, a hump between the tracks, or ruts. Ordinary ones run hill_sensing, spin_on_peak or
/// training_drive, or go straight on over a bed so small that they come to their own ruts again;
/// half of them walk, sense hills or spin in a bed with walls and slopes of up to 25 degrees.
/// Every scenario is an experiment that `screed sim` can run.
StuckScenario stuck_scenario(std::uint64_t seed, ScenarioKind kind, double duration_s);

/// One tick: arguments of SlipWatch::tick() as they were, then the truth.
struct SlipTick {
  std::int16_t speed_left;  ///< TrackMotion, 0.1 mm/s
  std::int16_t effort_left;
  std::int16_t speed_right;
  std::int16_t effort_right;
  std::array<std::int16_t, 3> gyro;
  std::array<std::int16_t, 3> accel;
  std::int16_t sin_pitch_q14;
  std::int32_t yaw_rate;  ///< angle units/s
  bool running;
  float speed;        ///< of the chassis, forward, m/s
  float turn;         ///< of the chassis, as speed of a track, m/s
  float track_left;   ///< speed of the belt, m/s
  float track_right;  ///< likewise
};

struct SlipDrive {
  std::uint64_t seed = 0;
  ScenarioKind kind = ScenarioKind::kFree;
  std::string ground;   ///< rigid, or the soil's preset
  std::string trap;     ///< none without one
  std::string failure;  ///< of the physics; empty: none
  std::vector<SlipTick> ticks;
};

/// What the tick that the robot has just had was.
SlipTick slip_tick_of(const World& world);

/// The drive of a scenario before its first tick.
SlipDrive drive_of(const StuckScenario& scenario);

/// Drives until its end, a fault, or the physics' failure. `progress` gets the share of the
/// duration, and may stop it.
SlipDrive drive(const StuckScenario& scenario, const TaskProgress& progress = {});

/// As many drives as scenarios, on as many threads; results in the scenarios' order. `progress` is
/// called from any of the threads, never from two at once, with the share of all durations. With a
/// folder every drive is kept there as a file by its experiment's content, and one that is there
/// is read instead of driven: a stopped campaign goes on where it was. Throws RunError when the
/// folder cannot be written.
std::vector<SlipDrive> drive_all(const std::vector<StuckScenario>& scenarios, unsigned threads,
                                 const TaskProgress& progress = {},
                                 const std::filesystem::path& folder = {});

/// Calls work(i) for 0 to count - 1, from so many threads. After an exception none begins any more,
/// and it is thrown again.
void in_threads(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work);

/// Name of the file of a scenario's drive: kind, seed and a hash of its experiment's text.
std::string archive_name(const StuckScenario& scenario);

/// The drive of that file; nothing when there is no such file. Throws InputError when the file is
/// of another format or cut short.
std::optional<SlipDrive> read_drive(const std::filesystem::path& file,
                                    const StuckScenario& scenario);
/// The file appears complete or not at all. Throws RunError when it cannot be written.
void write_drive(const std::filesystem::path& file, const SlipDrive& drive);

}  // namespace screed::nn
