// Robots driven by the image that is flashed, under the microcontroller simulation, as far as the
// rest of the program needs to know. Needs no simavr; a build without it (MCU=no) has these
// functions too, and they refuse.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "host_sim/run/world/world.h"

namespace screed {

/// The default image of a board: <firmware folder>/<board>/screed.elf.
std::string default_image(const std::string& board);

/// Throws InputError for a robot whose image is missing, or lacks the algorithm that its parameters
/// name. Takes no time, unlike making a world.
void check_image(const RobotOptions& robot);

/// Robot `number` of the options, which has an image. Throws InputError for a missing or foreign
/// image, an unknown board, a build without simavr.
std::unique_ptr<RobotController> make_image_robot(const WorldOptions& options, Environment& plant,
                                                  std::size_t number);

}  // namespace screed
