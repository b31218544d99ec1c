// The boards this program knows by name: a folder boards/<name> each.
#pragma once

#include <filesystem>
#include <string>

#include "firmware/parameters/board_constants.h"
#include "host_sim/physics/vehicle/gear_motor.h"

namespace screed {

inline constexpr const char* kDefaultBoard = "a_star_32u4";

/// Throws InputError for an unknown name; lists the known ones.
const BoardConstants& board_constants_of(const std::string& name);

/// The robot model in the board's folder: its only .urdf file. Throws InputError.
std::filesystem::path board_model(const std::string& name);

struct BoardMotor {
  GearMotor motor;
  double counts_per_turn = 1000.0 / 3.0;  ///< of the encoder, per turn of the output shaft
};
/// The gear motors of the board's robot, from motor.ini in its folder; without one the Rover 5's.
/// Throws InputError.
BoardMotor board_motor(const std::string& name);

}  // namespace screed
