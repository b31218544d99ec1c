// Reads gamepads through SDL, those that are there and those that are plugged in later. The window
// asks it what an SDL event means.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/screed/viewer/input.h"

union SDL_Event;

namespace screed::viewer {

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
