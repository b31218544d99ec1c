// Dead zone and buttons.
#include "tools/screed/viewer/gamepad.h"

#include <algorithm>
#include <cmath>

namespace screed::viewer {

Key key_of(GamepadButton button) {
  for (const GamepadMapping& mapping : kGamepadMapping) {
    if (mapping.button == button) return mapping.key;
  }
  return 0;
}

double stick_value(int raw) {
  constexpr double kFull = 32767.0;
  constexpr double kDeadZone = 1.0 / 6.0;
  const double value = std::clamp(raw / kFull, -1.0, 1.0);
  const double beyond = (std::abs(value) - kDeadZone) / (1.0 - kDeadZone);
  return beyond <= 0.0 ? 0.0 : std::copysign(beyond, value);
}

}  // namespace screed::viewer
