// A model's extent from above.
#include "tools/screed/viewer/robot_shape.h"

#include <algorithm>
#include <string>

#include "host_sim/core/errors.h"

namespace screed::viewer {
namespace {

constexpr const char* kWheels[2][2] = {{"fl_Wheel", "bl_Wheel"}, {"fr_Wheel", "br_Wheel"}};

/// A wheel stands on its rim and turns about the robot's y.
Plate wheel_plate(const Assembly& robot, const char* name) {
  const int index = robot.body_index(name);
  if (index >= 0) {
    const AssemblyBody& body = robot.bodies[static_cast<size_t>(index)];
    for (const Shape& shape : body.collision) {
      const auto* cylinder = std::get_if<Cylinder>(&shape.geometry);
      if (cylinder == nullptr) continue;
      const Eigen::Vector3d centre = body.pose.translation();
      return {centre.x() - cylinder->radius, centre.x() + cylinder->radius,
              centre.y() - 0.5 * cylinder->length, centre.y() + 0.5 * cylinder->length};
    }
  }
  throw InputError(std::string("robot model: no wheel '") + name +
                   "' with a collision cylinder to draw");
}

Plate around(const Plate& a, const Plate& b) {
  return {std::min(a.back, b.back), std::max(a.front, b.front), std::min(a.right, b.right),
          std::max(a.left, b.left)};
}

}  // namespace

RobotShape shape_of(const Assembly& robot, bool tracks) {
  RobotShape shape;
  for (const auto& side : kWheels) {
    const Plate front = wheel_plate(robot, side[0]);
    const Plate rear = wheel_plate(robot, side[1]);
    if (tracks) {
      shape.running_gear.push_back(around(front, rear));
    } else {
      shape.running_gear.push_back(front);
      shape.running_gear.push_back(rear);
    }
    if (shape.left_gear == 0) shape.left_gear = shape.running_gear.size();
  }
  // The hull fills the room between the sides, as long as the wheels' axles are apart and a little.
  Plate all = shape.running_gear.front();
  for (const Plate& gear : shape.running_gear) all = around(all, gear);
  const double wheel =
      0.5 * (wheel_plate(robot, kWheels[0][0]).front - wheel_plate(robot, kWheels[0][0]).back);
  const double width = shape.running_gear.front().left - shape.running_gear.front().right;
  shape.hull = {all.back + 0.4 * wheel, all.front - 0.4 * wheel, all.right + 0.7 * width,
                all.left - 0.7 * width};
  return shape;
}

}  // namespace screed::viewer
