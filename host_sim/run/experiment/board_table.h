// The boards this program knows by name: a folder boards/<name> each.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/parameters/board_constants.h"
#include "host_sim/physics/vehicle/drive_train.h"

namespace screed {

/// The board that is meant when none is named: DEFAULT_BOARD in tools/build/options.mk.
extern const char* const kDefaultBoard;

/// By name.
std::vector<std::string> board_names();

/// Throws InputError for an unknown name; lists the known ones.
const BoardConstants& board_constants_of(const std::string& name);

/// The robot model in the board's folder: its only .urdf file. Throws InputError.
std::filesystem::path board_model(const std::string& name);

/// The file of this name in the first board's folder that has one.
std::optional<std::filesystem::path> file_of_a_board(const std::string& name);

struct BoardMotor {
  GearMotor motor;
  double counts_per_turn = 1000.0 / 3.0;  ///< of the encoder, per turn of the output shaft
};
/// The gear motors of the board's robot, from motor.ini in its folder; without one the Rover 5's.
/// Throws InputError.
BoardMotor board_motor(const std::string& name);

/// The battery of the board's robot, full, from battery.ini in its folder; nothing without one, or
/// without the folder. Throws InputError when the file says something else.
std::optional<Battery> board_battery(const std::string& name);
/// Its NiMH cells in series, 0 where nothing is known.
int board_battery_cells(const std::string& name);

}  // namespace screed
