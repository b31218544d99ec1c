// What the sticks and buttons of a gamepad mean. Knows no library: gamepad_input.h reads the
// device.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "tools/screed/viewer/keys.h"

namespace screed::viewer {

/// Named by place, as on any gamepad: south is A of an Xbox gamepad, the cross of a PlayStation
/// one.
enum class GamepadButton : uint8_t {
  kSouth,
  kEast,
  kWest,
  kNorth,
  kBack,
  kStart,
  kLeftShoulder,
  kRightShoulder
};

enum class GamepadAxis : uint8_t { kTurn, kDrive };

/// A button does what a key does.
struct GamepadMapping {
  GamepadButton button;
  Key key;
  const char* name;  ///< on most gamepads
  const char* what;
};
inline constexpr std::array<GamepadMapping, 8> kGamepadMapping = {{
    {GamepadButton::kEast, kKeyEmergencyStop, "B", "emergency stop"},
    {GamepadButton::kSouth, kKeyBackspace, "A", "the algorithm drives again"},
    {GamepadButton::kWest, 'c', "X", "clear a fault, drive on"},
    {GamepadButton::kNorth, 'f', "Y", "follow the robot"},
    {GamepadButton::kStart, 'p', "Start", "pause, go on"},
    {GamepadButton::kBack, 'h', "Back", "these keys"},
    {GamepadButton::kLeftShoulder, '-', "LB", "slower"},
    {GamepadButton::kRightShoulder, '+', "RB", "faster"},
}};

/// The key of a button.
Key key_of(GamepadButton button);

/// -1..1 of an axis' raw -32768..32767. Within the dead zone, a sixth of its travel, exactly 0: a
/// worn stick does not come to rest in its centre. From there it rises evenly to full travel.
double stick_value(int raw);

/// Where a stick stands.
struct Stick {
  double forward = 0.0;  ///< -1..1
  double left = 0.0;     ///< -1..1

  bool held() const { return forward != 0.0 || left != 0.0; }
};

}  // namespace screed::viewer
