// Gamepads as SDL reports them: virtual ones, which SDL makes for programs that test themselves.
#include "tools/screed/viewer/window.h"

#include <gtest/gtest.h>

#define SDL_MAIN_HANDLED
#include <SDL.h>

namespace screed::viewer {
namespace {

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
