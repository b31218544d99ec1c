// Runs an experiment: lets the firmware drive in its world (world_setup.h) tick by tick, records
// everything, leaves a run folder. The tick itself is in run_loop.cpp.
#pragma once

#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/run_report.h"
#include "host_sim/run/simulation/simulation_options.h"

namespace screed {

/// Throws InputError when the experiment cannot be run, as run_simulation would.
void check_simulation(const Experiment& experiment, const SimulationOptions& options);

/// Runs to the end of the duration or until told to stop. Throws InputError before anything is
/// written, RunError when the run cannot be saved; then nothing half-written stays behind.
SimulationSummary run_simulation(const Experiment& experiment, const SimulationOptions& options);

}  // namespace screed
