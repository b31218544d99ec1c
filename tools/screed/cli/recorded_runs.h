// Which experiments of a batch have been run already, for --missing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/run/experiment/experiment.h"

namespace screed {

/// Removes the experiments that have a run NAME-0001 in `root` (without it, in their own
/// output_directory_prefix) and says on stderr how many. Notes there as well which of these runs
/// ended early or are runs of other values: they stay as they are. Throws InputError when a folder
/// of that name is no run, or is left over from one that did not end.
void leave_out_recorded(std::vector<Experiment>& experiments,
                        const std::optional<std::string>& root);

}  // namespace screed
