// Gamepads: dead zone, what sticks and buttons ask for, hot plug; and as SDL reports virtual ones,
// which it makes for programs that test themselves.
#include <gtest/gtest.h>

#define SDL_MAIN_HANDLED
#include <SDL.h>

#include "tools/screed/viewer/input.h"
#include "tools/screed/viewer/window.h"

namespace screed::viewer {
namespace {

InputEvent axis_event(GamepadAxis axis, double amount) {
  InputEvent event;
  event.kind = InputEvent::Kind::kGamepadAxis;
  event.axis = axis;
  event.amount = amount;
  return event;
}

InputEvent plug_event(bool in) {
  InputEvent event;
  event.kind = in ? InputEvent::Kind::kGamepadAdded : InputEvent::Kind::kGamepadRemoved;
  event.name = "pad";
  return event;
}

TEST(Gamepad, AStickAtRestIsExactlyZero) {
  EXPECT_EQ(stick_value(0), 0.0);
  EXPECT_EQ(stick_value(5400), 0.0);
  EXPECT_EQ(stick_value(-5400), 0.0);
  // It begins gently and reaches its full travel on both sides.
  EXPECT_GT(stick_value(5600), 0.0);
  EXPECT_LT(stick_value(5600), 0.02);
  EXPECT_EQ(stick_value(32767), 1.0);
  EXPECT_EQ(stick_value(-32768), -1.0);
  EXPECT_EQ(stick_value(-20000), -stick_value(20000));
  EXPECT_LT(stick_value(15000), stick_value(16000));
}

TEST(Gamepad, EveryButtonDoesWhatAKeyDoesAndIsListed) {
  Controls controls(false, 1.0);
  const size_t without = controls.help_lines().size();
  controls.gamepad_event(plug_event(true));
  const std::vector<HelpLine> help = controls.help_lines();
  EXPECT_EQ(help.size(), without + kGamepadMapping.size());
  for (const GamepadMapping& mapping : kGamepadMapping) {
    EXPECT_EQ(key_of(mapping.button), mapping.key);
    bool listed = false;
    for (const HelpLine& line : help) listed = listed || line.what == mapping.what;
    EXPECT_TRUE(listed) << mapping.what;
  }
  controls.key_down(key_of(GamepadButton::kEast), false);
  EXPECT_TRUE(controls.emergency_stop);
  controls.key_down(key_of(GamepadButton::kSouth), false);
  EXPECT_TRUE(controls.hand_back);
}

TEST(Gamepad, TheStickDrivesBesideTheKeys) {
  Controls controls(false, 1.0);
  controls.gamepad_event(plug_event(true));
  EXPECT_FALSE(controls.drives());
  controls.gamepad_event(axis_event(GamepadAxis::kDrive, 0.5));
  controls.gamepad_event(axis_event(GamepadAxis::kTurn, -0.25));
  EXPECT_TRUE(controls.drives());
  EXPECT_TRUE(controls.driven_by_gamepad());
  EXPECT_EQ(controls.forward(), 0.5);
  EXPECT_EQ(controls.left(), -0.25);
  controls.key_down(kKeyUp, false);
  EXPECT_EQ(controls.forward(), 1.0) << "no faster than full speed";
  EXPECT_FALSE(controls.driven_by_gamepad());
  controls.key_up(kKeyUp);
  controls.gamepad_event(axis_event(GamepadAxis::kDrive, 0.0));
  controls.gamepad_event(axis_event(GamepadAxis::kTurn, 0.0));
  EXPECT_FALSE(controls.drives());
}

TEST(Gamepad, PulledOutItDrivesNoMore) {
  Controls controls(false, 1.0);
  controls.gamepad_event(plug_event(true));
  EXPECT_EQ(controls.gamepad(), "pad");
  controls.gamepad_event(axis_event(GamepadAxis::kDrive, 1.0));
  controls.gamepad_event(plug_event(false));
  EXPECT_FALSE(controls.drives());
  EXPECT_EQ(controls.forward(), 0.0);
  EXPECT_TRUE(controls.gamepad().empty());
}

class GamepadInputTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    SDL_SetMainReady();
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
  }

  static int plug_in() {
    return SDL_JoystickAttachVirtual(SDL_JOYSTICK_TYPE_GAMECONTROLLER, SDL_CONTROLLER_AXIS_MAX,
                                     SDL_CONTROLLER_BUTTON_MAX, 0);
  }

  /// What has happened since the last call.
  std::vector<InputEvent> events() {
    std::vector<InputEvent> found;
    SDL_JoystickUpdate();
    SDL_Event event;
    while (SDL_PollEvent(&event) != 0) {
      // A gamepad of this machine is not the test's.
      input_.convert(event, found);
    }
    return found;
  }

  GamepadInput input_;
};

TEST_F(GamepadInputTest, PluggedInMovedPressedAndPulledOut) {
  events();
  const int device = plug_in();
  ASSERT_GE(device, 0) << SDL_GetError();
  std::vector<InputEvent> got = events();
  ASSERT_GE(got.size(), 1U);
  EXPECT_EQ(got[0].kind, InputEvent::Kind::kGamepadAdded);
  EXPECT_FALSE(got[0].name.empty());

  SDL_Joystick* const stick = SDL_JoystickFromInstanceID(SDL_JoystickGetDeviceInstanceID(device));
  ASSERT_NE(stick, nullptr) << "not opened";
  // Up and to the left: SDL counts to the right and downwards.
  SDL_JoystickSetVirtualAxis(stick, SDL_CONTROLLER_AXIS_LEFTY, -32768);
  SDL_JoystickSetVirtualAxis(stick, SDL_CONTROLLER_AXIS_LEFTX, -20000);
  Controls controls(false, 1.0);
  for (const InputEvent& event : events()) {
    if (event.kind == InputEvent::Kind::kGamepadAxis) controls.gamepad_event(event);
  }
  EXPECT_EQ(controls.forward(), 1.0);
  EXPECT_GT(controls.left(), 0.4);
  EXPECT_LT(controls.left(), 0.7);

  SDL_JoystickSetVirtualButton(stick, SDL_CONTROLLER_BUTTON_B, SDL_PRESSED);
  got = events();
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0].kind, InputEvent::Kind::kKeyPressed);
  EXPECT_EQ(got[0].key, kKeyEmergencyStop);
  SDL_JoystickSetVirtualButton(stick, SDL_CONTROLLER_BUTTON_B, SDL_RELEASED);
  got = events();
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0].kind, InputEvent::Kind::kKeyReleased);

  SDL_JoystickDetachVirtual(device);
  got = events();
  ASSERT_FALSE(got.empty());
  EXPECT_EQ(got.back().kind, InputEvent::Kind::kGamepadRemoved);

  // Another one, plugged in later, drives again.
  const int second = plug_in();
  got = events();
  ASSERT_GE(got.size(), 1U);
  EXPECT_EQ(got[0].kind, InputEvent::Kind::kGamepadAdded);
  SDL_JoystickDetachVirtual(second);
  events();
}

}  // namespace
}  // namespace screed::viewer
