// Keys and mouse, and what they ask the viewer to do. Knows no window system.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/render/picture/canvas.h"
#include "tools/screed/viewer/scene.h"
#include "tools/screed/viewer/terrain_image.h"

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

struct InputEvent {
  enum class Kind : uint8_t {
    kKeyPressed,
    kKeyReleased,
    kWheel,
    kPress,
    kMove,
    kRelease,
    kSize,
    kClose
  };

  Kind kind = Kind::kClose;
  Key key = 0;
  bool shift = false;
  Pixel at{0.0, 0.0};   ///< of the mouse
  double amount = 0.0;  ///< of the wheel, clicks away from the user
  int width = 0;        ///< of the window, kSize
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
  bool clear_fault = false;

  /// Of the arrow keys held down: forward and left, -1..1; slowly with shift.
  double forward() const;
  double left() const;
  bool drive_keys_held() const { return up_ || down_ || left_ || right_; }

  /// "x 1", "x 0.25", "max".
  std::string pace_text() const;
  const std::vector<HelpLine>& help_lines() const;

 private:
  void change_pace(bool faster);
  void drive_key(Key key, bool held);

  bool recorded_;
  bool up_ = false;
  bool down_ = false;
  bool left_ = false;
  bool right_ = false;
  bool slow_ = false;
};

}  // namespace screed::viewer
