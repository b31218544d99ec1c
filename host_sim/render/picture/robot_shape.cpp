// A model's extent from above.
#include "host_sim/render/picture/robot_shape.h"

#include <algorithm>

namespace screed {
namespace {

RobotPlate wheel_plate(const AssemblyWheel& wheel) {
  return {wheel.centre.x() - wheel.radius_m, wheel.centre.x() + wheel.radius_m,
          wheel.centre.y() - 0.5 * wheel.width_m, wheel.centre.y() + 0.5 * wheel.width_m};
}

RobotPlate around(const RobotPlate& a, const RobotPlate& b) {
  return {std::min(a.back, b.back), std::max(a.front, b.front), std::min(a.right, b.right),
          std::max(a.left, b.left)};
}

}  // namespace

RobotShape shape_of(const Assembly& robot, bool tracks) {
  RobotShape shape;
  for (const auto& side : robot.wheels) {
    const RobotPlate front = wheel_plate(side[0]);
    const RobotPlate rear = wheel_plate(side[1]);
    if (tracks) {
      shape.running_gear.push_back(around(front, rear));
    } else {
      shape.running_gear.push_back(front);
      shape.running_gear.push_back(rear);
    }
    if (shape.left_gear == 0) shape.left_gear = shape.running_gear.size();
  }
  // The hull fills the room between the sides, as long as the wheels' axles are apart and a little.
  RobotPlate all = shape.running_gear.front();
  for (const RobotPlate& gear : shape.running_gear) all = around(all, gear);
  const double wheel = robot.wheels[0][0].radius_m;
  const double width = shape.running_gear.front().left - shape.running_gear.front().right;
  shape.hull = {all.back + 0.4 * wheel, all.front - 0.4 * wheel, all.right + 0.7 * width,
                all.left - 0.7 * width};
  return shape;
}

}  // namespace screed
