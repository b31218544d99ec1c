// The robot of an experiment: its model file, and how that is read; its battery.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/drive_train.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/experiment.h"

namespace screed {

/// The robot of [vehicle], on a board of boards/; or that of `file`, with the same roles and leg
/// angle. Throws InputError.
Assembly make_robot_model(const Experiment& experiment, const std::string& board = kDefaultBoard,
                          const std::optional<std::filesystem::path>& file = std::nullopt);

/// The battery of the board's robot, as [battery] has it begin. Throws InputError.
Battery make_battery(const Experiment& experiment, const std::string& board);

}  // namespace screed
