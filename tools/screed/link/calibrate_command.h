// `screed calibrate`: walks a person through calibrating a robot's IMU over the radio and stores
// what was found in the robot.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

void register_calibrate_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
