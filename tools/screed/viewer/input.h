// Keys, mouse and gamepad, and what they ask the viewer to do. Knows no window system and no
// library: window.h reads the devices.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/render/picture/canvas.h"
#include "tools/screed/cli/terminal_screen.h"
#include "tools/screed/viewer/ground_view.h"
#include "tools/screed/viewer/scene.h"

namespace screed::viewer {

/// The character of a key, small; or one of these.
using Key = int;
inline constexpr Key kKeyLeft = 256;
inline constexpr Key kKeyRight = 257;
inline constexpr Key kKeyUp = 258;
inline constexpr Key kKeyDown = 259;
inline constexpr Key kKeyHome = 260;
inline constexpr Key kKeyEnd = 261;
inline constexpr Key kKeyEscape = 262;
inline constexpr Key kKeyBackspace = 263;
inline constexpr Key kKeyF12 = 264;
inline constexpr Key kKeyEmergencyStop = kEmergencyStopKey;

/// Named by place, as on any gamepad: south is A of an Xbox gamepad, the cross of a PlayStation
/// one. Numbered as SDL_GameControllerButton.
enum class GamepadButton : uint8_t {
  kSouth = 0,
  kEast = 1,
  kWest = 2,
  kNorth = 3,
  kBack = 4,
  kStart = 6,
  kLeftShoulder = 9,
  kRightShoulder = 10
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

/// The key of a button; 0: it has none.
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

struct InputEvent {
  enum class Kind : uint8_t {
    kKeyPressed,
    kKeyReleased,
    kWheel,
    kPress,
    kMove,
    kRelease,
    kSize,
    kGamepadAdded,
    kGamepadRemoved,
    kGamepadAxis,
    kClose
  };

  Kind kind = Kind::kClose;
  Key key = 0;
  bool shift = false;
  Pixel at{0.0, 0.0};   ///< of the mouse
  double amount = 0.0;  ///< of the wheel, clicks away from the user; of an axis, -1..1
  GamepadAxis axis = GamepadAxis::kTurn;
  std::string name;  ///< of the gamepad
  int width = 0;     ///< of the window, kSize
  int height = 0;
};

/// A key that a script holds down from one time of the run to another, s.
struct ScriptedKey {
  Key key = 0;
  double from_s = 0.0;
  double to_s = 0.0;
};

/// "m@2", "Up@3-5.5". Throws InputError that says what is allowed.
ScriptedKey parse_scripted_key(const std::string& text);

/// What the script's keys do between two times: pressed in (from, to], released likewise.
std::vector<InputEvent> scripted_events(const std::vector<ScriptedKey>& script, double after_s,
                                        double until_s);

/// What the user has asked for so far.
class Controls {
 public:
  /// A run that goes on is driven with the arrow keys; a recorded one is scrubbed.
  explicit Controls(bool recorded, double pace);

  void key_down(Key key, bool shift);
  void key_up(Key key);
  /// What a gamepad's event asks for; buttons come as keys.
  void gamepad_event(const InputEvent& event);

  bool recorded() const { return recorded_; }
  bool paused = false;
  bool closed = false;
  bool follow = false;
  bool trail = true;
  bool help = false;
  bool recording = false;
  Shading shading = Shading::kHeight;
  double pace = 1.0;  ///< simulated seconds a second; 0: as fast as it goes

  // Asked for once; whoever does it takes it back.
  bool fit = false;
  bool screenshot = false;
  int steps = 0;
  std::optional<double> jump_s;    ///< in a recording: by so much
  std::optional<double> to_share;  ///< in a recording: to there, 0..1
  bool hand_back = false;          ///< the algorithm is to drive again
  bool emergency_stop = false;
  bool clear_fault = false;

  double forward() const;
  double left() const;
  /// The user drives now: arrow keys are held down, or the stick is out of its dead zone.
  bool drives() const { return drive_keys_held() || stick_.held(); }
  /// What the user drove with last.
  bool driven_by_gamepad() const { return driven_by_gamepad_; }
  /// The gamepad that is plugged in; empty: none.
  const std::string& gamepad() const { return gamepad_; }

  /// "x 1", "x 0.25", "max".
  std::string pace_text() const;
  /// What the keys do; the gamepad's buttons as well, when there is one.
  std::vector<HelpLine> help_lines() const;
  /// The line at the foot of the panel.
  std::string key_hint() const;

 private:
  bool drive_keys_held() const { return up_ || down_ || left_ || right_; }
  void change_pace(bool faster);
  void drive_key(Key key, bool held);

  bool recorded_;
  bool up_ = false;
  bool down_ = false;
  bool left_ = false;
  bool right_ = false;
  bool slow_ = false;
  Stick stick_;
  std::string gamepad_;
  bool driven_by_gamepad_ = false;
};

}  // namespace screed::viewer
