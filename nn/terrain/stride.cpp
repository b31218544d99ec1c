#include "nn/terrain/stride.h"

#include <cstddef>

namespace screed::nn {

std::array<WheelPosition, 4> wheel_positions(const Assembly& robot) {
  std::array<WheelPosition, 4> positions;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const AssemblyWheel& wheel = robot.wheels[i % 2][i / 2];
    positions[i] = {wheel.centre.x(), wheel.centre.y(), wheel.radius_m, i < 2};
  }
  return positions;
}

}  // namespace screed::nn
