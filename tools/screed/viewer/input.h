// Keys and mouse, and what they ask the viewer to do. Knows no window system.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/render/picture/canvas.h"
#include "tools/screed/viewer/gamepad.h"
#include "tools/screed/viewer/keys.h"
#include "tools/screed/viewer/scene.h"
#include "tools/screed/viewer/terrain_image.h"

namespace screed::viewer {

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

  /// Of the arrow keys held down and the stick: forward and left, -1..1; slowly with shift.
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
