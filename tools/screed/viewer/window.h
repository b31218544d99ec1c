// A window on the screen that shows a canvas and tells what the user does to it, with keys, mouse
// or a gamepad. This file and gamepad_input.cpp alone know SDL.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host_sim/render/picture/canvas.h"
#include "tools/screed/viewer/input.h"

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

}  // namespace screed::viewer
