// A window on the screen that shows a canvas and tells what the user does to it, with keys, mouse
// or a gamepad. These files alone know SDL.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host_sim/render/picture/canvas.h"
#include "tools/screed/viewer/input.h"

union SDL_Event;

namespace screed::viewer {

/// Throws InputError when a window would open where nobody sees it: no screen can be reached, and
/// SDL_VIDEODRIVER does not ask for a driver without one. Where it does, prints a note.
void require_screen();

class Window {
 public:
  /// Throws InputError as require_screen(), RunError when the window cannot be opened.
  Window(const std::string& title, int width_px, int height_px);
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;
  ~Window();

  /// What happened since the last call; waits at most so long for something to happen.
  std::vector<InputEvent> events(int wait_ms);
  void show(Canvas& canvas);
  /// How it comes to the screen: "x11", "wayland", "dummy".
  std::string driver() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads gamepads, those that are there and those that are plugged in later. The window asks it
/// what an SDL event means.
class GamepadInput {
 public:
  /// Without gamepads, or without the right to read them, this does nothing.
  GamepadInput();
  GamepadInput(const GamepadInput&) = delete;
  GamepadInput& operator=(const GamepadInput&) = delete;
  ~GamepadInput();

  /// What happened since the last call, for a program without a window.
  std::vector<InputEvent> poll();
  /// Adds what the event means to `events`; nothing when it is none of a gamepad.
  void convert(const SDL_Event& event, std::vector<InputEvent>& events);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace screed::viewer
