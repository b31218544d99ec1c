// Seeded drives with and without a trap, to train the robot's slip watch and to measure it.
#pragma once

#include <cstdint>
#include <string>

#include "host_sim/run/experiment/experiment.h"

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

}  // namespace screed::nn
