// SDL's game controllers: gamepads whose buttons and sticks SDL knows by place.
#include "tools/screed/viewer/gamepad_input.h"

#define SDL_MAIN_HANDLED
#include <SDL.h>

#include <optional>

namespace screed::viewer {
namespace {

std::optional<GamepadButton> button_of(uint8_t button) {
  switch (button) {
    case SDL_CONTROLLER_BUTTON_A:
      return GamepadButton::kSouth;
    case SDL_CONTROLLER_BUTTON_B:
      return GamepadButton::kEast;
    case SDL_CONTROLLER_BUTTON_X:
      return GamepadButton::kWest;
    case SDL_CONTROLLER_BUTTON_Y:
      return GamepadButton::kNorth;
    case SDL_CONTROLLER_BUTTON_BACK:
      return GamepadButton::kBack;
    case SDL_CONTROLLER_BUTTON_START:
      return GamepadButton::kStart;
    case SDL_CONTROLLER_BUTTON_LEFTSHOULDER:
      return GamepadButton::kLeftShoulder;
    case SDL_CONTROLLER_BUTTON_RIGHTSHOULDER:
      return GamepadButton::kRightShoulder;
    default:
      return std::nullopt;
  }
}

}  // namespace

/// One gamepad at a time: the one that was there first. Another one waits until it is gone.
class GamepadInput::Impl {
 public:
  Impl() : works_(SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) == 0) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (controller_ != nullptr) SDL_GameControllerClose(controller_);
    if (works_) SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  }

  void convert(const SDL_Event& from, std::vector<InputEvent>& events) {
    switch (from.type) {
      case SDL_CONTROLLERDEVICEADDED:
        open(from.cdevice.which, events);
        break;
      case SDL_CONTROLLERDEVICEREMOVED:
        remove(from.cdevice.which, events);
        break;
      case SDL_CONTROLLERAXISMOTION:
        if (from.caxis.which == id_) add_axis(from.caxis, events);
        break;
      case SDL_CONTROLLERBUTTONDOWN:
      case SDL_CONTROLLERBUTTONUP:
        if (from.cbutton.which == id_) add_button(from.cbutton, events);
        break;
      default:
        break;
    }
  }

 private:
  void open(int index, std::vector<InputEvent>& events) {
    if (controller_ != nullptr) return;
    controller_ = SDL_GameControllerOpen(index);
    if (controller_ == nullptr) return;
    id_ = SDL_JoystickInstanceID(SDL_GameControllerGetJoystick(controller_));
    const char* const name = SDL_GameControllerName(controller_);
    InputEvent event;
    event.kind = InputEvent::Kind::kGamepadAdded;
    event.name = name == nullptr ? "gamepad" : name;
    events.push_back(event);
  }

  void remove(SDL_JoystickID id, std::vector<InputEvent>& events) {
    if (controller_ == nullptr || id != id_) return;
    SDL_GameControllerClose(controller_);
    controller_ = nullptr;
    id_ = kNone;
    InputEvent event;
    event.kind = InputEvent::Kind::kGamepadRemoved;
    events.push_back(event);
    for (int index = 0; index < SDL_NumJoysticks() && controller_ == nullptr; ++index) {
      if (SDL_IsGameController(index) == SDL_TRUE) open(index, events);
    }
  }

  static void add_axis(const SDL_ControllerAxisEvent& from, std::vector<InputEvent>& events) {
    InputEvent event;
    event.kind = InputEvent::Kind::kGamepadAxis;
    // SDL counts to the right and downwards.
    event.amount = -stick_value(from.value);
    if (from.axis == SDL_CONTROLLER_AXIS_LEFTX) {
      event.axis = GamepadAxis::kTurn;
    } else if (from.axis == SDL_CONTROLLER_AXIS_LEFTY) {
      event.axis = GamepadAxis::kDrive;
    } else {
      return;
    }
    events.push_back(event);
  }

  static void add_button(const SDL_ControllerButtonEvent& from, std::vector<InputEvent>& events) {
    const std::optional<GamepadButton> button = button_of(from.button);
    if (!button.has_value()) return;
    InputEvent event;
    event.kind =
        from.state == SDL_PRESSED ? InputEvent::Kind::kKeyPressed : InputEvent::Kind::kKeyReleased;
    event.key = key_of(*button);
    events.push_back(event);
  }

  static constexpr SDL_JoystickID kNone = -1;

  bool works_;
  SDL_GameController* controller_ = nullptr;
  SDL_JoystickID id_ = kNone;
};

GamepadInput::GamepadInput() : impl_(std::make_unique<Impl>()) {}
GamepadInput::~GamepadInput() = default;

std::vector<InputEvent> GamepadInput::poll() {
  std::vector<InputEvent> events;
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) convert(event, events);
  return events;
}

void GamepadInput::convert(const SDL_Event& event, std::vector<InputEvent>& events) {
  impl_->convert(event, events);
}

}  // namespace screed::viewer
