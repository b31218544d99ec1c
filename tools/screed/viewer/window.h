// A window on the screen that shows a canvas and tells what the user does to it. The only file of
// the viewer that knows SDL.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host_sim/render/picture/canvas.h"
#include "tools/screed/viewer/input.h"

namespace screed::viewer {

class Window {
 public:
  /// Throws RunError when there is no screen to open one on.
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
