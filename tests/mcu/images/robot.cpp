// Test image: the robot's core alone. Takes samples from the serial line, answers each with the
// output of that tick.
#include "firmware/robot/robot.h"
#include "board.h"
#include "tests/mcu/images/image_link.h"
#include "tests/mcu/sample_wire.h"
#include "tests/mcu/test_credentials.h"

int main() {
  using namespace screed;
  ImageLink link;
  const Parameters parameters;
  Robot robot(kBoard, parameters, kTestCredentials);
  SensorSample sample{};
  RobotOutput output{};
  for (;;) {
    get_sample(link, sample);
    robot.tick(sample, output);
    put_output(link, output);
  }
}
