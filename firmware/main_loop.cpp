// The main loop: the only code of the firmware that talks to the hardware abstraction layer.
#include "firmware/main_loop.h"

#include "firmware/robot/robot.h"
#include "hal/hal.h"

namespace screed {

void main_loop() {
  hal::init();
  Robot robot(hal::board_constants(), hal::parameters());
  SensorSample sample{};
  RobotOutput output{};
  while (hal::wait_for_tick()) {
    hal::read_sensors(sample);
    robot.tick(sample, output);
    hal::write_outputs(output);
  }
}

}  // namespace screed
