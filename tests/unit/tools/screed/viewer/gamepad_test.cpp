// Sticks and buttons: dead zone, what they ask for, hot plug.
#include "tools/screed/viewer/input.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace screed::viewer
