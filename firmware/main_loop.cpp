// The main loop: the only code of the firmware that talks to the hardware abstraction layer.
#include "firmware/main_loop.h"

#ifdef __AVR__
#include <stddef.h>
#else
#include <new>
#endif

#include "firmware/robot/robot.h"
#include "hal/hal.h"

/// On the AVR the robot has a fixed address: what lies further than 63 bytes into a stack frame
/// costs 20 bytes of code to reach, every time. It is made where it lies, since this function runs
/// once: of a static object the compiler would have to remember whether it is there. A host runs
/// several robots, and keeps them itself.
#ifdef __AVR__
#define SCREED_RESIDENT static
#else
#define SCREED_RESIDENT
#endif

#ifdef __AVR__
// avr-libc has no <new>.
inline void* operator new(size_t /*size*/, void* place) noexcept {
  return place;
}
#endif

namespace screed {

void tick_firmware(Robot& robot, SensorSample& sample, RobotOutput& output) {
  hal::read_sensors(sample);
  robot.tick(sample, output);
  hal::write_outputs(output);
}

void main_loop() {
  hal::init();
  alignas(Robot) SCREED_RESIDENT unsigned char place[sizeof(Robot)];
  Robot& robot = *new (place) Robot(hal::board_constants(), hal::parameters(), hal::credentials(),
                                    hal::parameters_intact());
  SCREED_RESIDENT SensorSample sample{};
  SCREED_RESIDENT RobotOutput output{};
  while (hal::wait_for_tick()) tick_firmware(robot, sample, output);
}

}  // namespace screed
