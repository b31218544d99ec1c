// In a build without simavr (MCU=no): what is left of images.
#include "host_sim/core/errors.h"
#include "host_sim/run/world/image_robot.h"

namespace screed {

void check_image(const RobotOptions& /*robot*/) {
  throw InputError("this program was built without the microcontroller simulation (MCU=no)");
}

std::unique_ptr<RobotController> make_image_robot(const WorldOptions& options,
                                                  Environment& /*plant*/, std::size_t number) {
  check_image(options.robots[number]);
  return nullptr;
}

}  // namespace screed
