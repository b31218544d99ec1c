// Seeded drives with and without a trap, to train the robot's slip watch and to measure it.
#pragma once

#include <cstdint>
#include <string>

#include "host_sim/run/experiment/experiment.h"

namespace screed::nn {

struct StuckScenario {
  Experiment experiment;
  bool trapped = false;
  std::string ground;  ///< rigid, or the soil's preset
};

/// A drive of this seed: on rigid ground (twice as often) or one of the named soils, hilly by up to
/// 8 degrees, straight on, in arcs or at random (Algorithm 6), at 0.08 to 0.2 m/s; its sensors have
/// the noise and the errors of their data sheets. A trapped one meets a wall, a slope too steep, a
/// trench, a hump between the tracks, or ruts within the first metre. Every scenario is an
/// experiment that `screed sim` can run.
StuckScenario stuck_scenario(std::uint64_t seed, bool trapped, double duration_s);

}  // namespace screed::nn
