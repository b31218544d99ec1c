// SDL 2. The canvas is copied to the window's own surface: no graphics card is needed, and what is
// seen is what a screenshot holds.
#include "tools/screed/viewer/window.h"

#include <cstdlib>
#include <iostream>

#define SDL_MAIN_HANDLED
#include <SDL.h>

#include <optional>

#include "host_sim/core/errors.h"
#include "tools/screed/viewer/layout.h"

namespace screed::viewer {
namespace {

RunError failure(const std::string& what) {
  return RunError(what + ": " + SDL_GetError());
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string video_driver() {
  const char* name = SDL_GetCurrentVideoDriver();
  return name == nullptr ? "" : name;
}

/// Drivers that draw where nobody looks. SDL falls back to them by itself.
bool is_invisible(const std::string& driver) {
  return driver == "offscreen" || driver == "dummy" || driver == "evdev";
}

InputError no_screen(const std::string& reason) {
  return InputError("the viewer has no screen: " + reason +
                    "; --screenshot FILE and --frames-dir FOLDER draw without a window, "
                    "SDL_VIDEODRIVER=dummy opens an invisible one");
}

/// Balanced by SDL_QuitSubSystem() when it returns.
void start_video() {
  const std::string wanted = variable("SDL_VIDEODRIVER");
  // Without that folder Wayland's library finds no screen and prints a line of its own.
  if (wanted.empty() && variable("XDG_RUNTIME_DIR").empty())
    SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11,KMSDRM,offscreen");
  if (SDL_InitSubSystem(SDL_INIT_VIDEO) == 0) {
    if (!wanted.empty() || !is_invisible(video_driver())) return;
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
  }
  if (!wanted.empty()) throw no_screen("SDL_VIDEODRIVER=" + wanted + ": " + SDL_GetError());
  std::string reason;
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"}) {
    const std::string value = variable(name);
    if (!reason.empty()) reason += ", ";
    reason += std::string(name) + (value.empty() ? " is not set" : "=" + value + " leads to none");
  }
  throw no_screen(reason);
}

Key key_of(SDL_Keycode code) {
  switch (code) {
    case SDLK_LEFT:
      return kKeyLeft;
    case SDLK_RIGHT:
      return kKeyRight;
    case SDLK_UP:
      return kKeyUp;
    case SDLK_DOWN:
      return kKeyDown;
    case SDLK_HOME:
      return kKeyHome;
    case SDLK_END:
      return kKeyEnd;
    case SDLK_ESCAPE:
      return kKeyEscape;
    case SDLK_BACKSPACE:
      return kKeyBackspace;
    case SDLK_F12:
      return kKeyF12;
    case SDLK_PAUSE:
      return 'p';
    case SDLK_KP_PLUS:
      return '+';
    case SDLK_KP_MINUS:
      return '-';
    case SDLK_F1:
      return 'h';
    default:
      return code > 0 && code < 128 ? static_cast<Key>(code) : 0;
  }
}

}  // namespace

class Window::Impl {
 public:
  Impl(const std::string& title, int width_px, int height_px) {
    SDL_SetMainReady();
    // Ctrl-C is ours.
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    // On X the surface goes straight to the server; SDL's way round a texture is slower without a
    // graphics card and no faster with one.
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
    SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0");
    start_video();
    if (video_driver() == "wayland") SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "1");
    window_ = SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED,
                               width_px, height_px, SDL_WINDOW_RESIZABLE);
    if (window_ == nullptr) {
      const RunError error = failure("the viewer cannot open its window");
      SDL_QuitSubSystem(SDL_INIT_VIDEO);
      throw error;
    }
    SDL_SetWindowMinimumSize(window_, kMinWindowWidth_px, kMinWindowHeight_px);
    gamepads_.emplace();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    gamepads_.reset();
    SDL_DestroyWindow(window_);
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
    SDL_Quit();
  }

  std::vector<InputEvent> events(int wait_ms) {
    std::vector<InputEvent> events;
    SDL_Event event;
    bool more =
        wait_ms > 0 ? SDL_WaitEventTimeout(&event, wait_ms) != 0 : SDL_PollEvent(&event) != 0;
    while (more) {
      convert_event(event, events);
      gamepads_->convert(event, events);
      more = SDL_PollEvent(&event) != 0;
    }
    return events;
  }

  void show(Canvas& canvas) const {
    SDL_Surface* screen = SDL_GetWindowSurface(window_);
    if (screen == nullptr) throw failure("the viewer cannot draw");
    constexpr int kBits = 32;
    SDL_Surface* picture =
        SDL_CreateRGBSurfaceWithFormatFrom(canvas.pixels().data(), canvas.width(), canvas.height(),
                                           kBits, canvas.width() * 4, SDL_PIXELFORMAT_RGB888);
    if (picture == nullptr) throw failure("the viewer cannot draw");
    SDL_BlitSurface(picture, nullptr, screen, nullptr);
    SDL_FreeSurface(picture);
    // Fails while the window changes its size; the next frame has the new one.
    SDL_UpdateWindowSurface(window_);
  }

 private:
  static void convert_event(const SDL_Event& from, std::vector<InputEvent>& events) {
    using Kind = InputEvent::Kind;
    InputEvent event;
    switch (from.type) {
      case SDL_QUIT:
        event.kind = Kind::kClose;
        break;
      case SDL_KEYDOWN:
      case SDL_KEYUP:
        event.kind = from.type == SDL_KEYDOWN ? Kind::kKeyPressed : Kind::kKeyReleased;
        event.key = key_of(from.key.keysym.sym);
        event.shift = (from.key.keysym.mod & KMOD_SHIFT) != 0;
        // A key held down repeats where that is of use.
        if (event.key == 0 || (from.key.repeat != 0 && event.key != '.' && event.key != kKeyLeft &&
                               event.key != kKeyRight)) {
          return;
        }
        break;
      case SDL_MOUSEWHEEL:
        event.kind = Kind::kWheel;
        event.amount = static_cast<double>(from.wheel.preciseY);
        event.at = {static_cast<double>(from.wheel.mouseX), static_cast<double>(from.wheel.mouseY)};
        break;
      case SDL_MOUSEBUTTONDOWN:
      case SDL_MOUSEBUTTONUP:
        if (from.button.button != SDL_BUTTON_LEFT) return;
        event.kind = from.type == SDL_MOUSEBUTTONDOWN ? Kind::kPress : Kind::kRelease;
        event.at = {static_cast<double>(from.button.x), static_cast<double>(from.button.y)};
        break;
      case SDL_MOUSEMOTION:
        if ((from.motion.state & SDL_BUTTON_LMASK) == 0) return;
        event.kind = Kind::kMove;
        event.at = {static_cast<double>(from.motion.x), static_cast<double>(from.motion.y)};
        break;
      case SDL_WINDOWEVENT:
        if (from.window.event != SDL_WINDOWEVENT_SIZE_CHANGED) return;
        event.kind = Kind::kSize;
        event.width = from.window.data1;
        event.height = from.window.data2;
        break;
      default:
        return;
    }
    events.push_back(event);
  }

  SDL_Window* window_ = nullptr;
  std::optional<GamepadInput> gamepads_;
};

void require_screen() {
  SDL_SetMainReady();
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
  start_video();
  const std::string driver = video_driver();
  SDL_QuitSubSystem(SDL_INIT_VIDEO);
  if (is_invisible(driver))
    std::cerr << "note: SDL_VIDEODRIVER=" << driver << ": the window is invisible\n";
}

Window::Window(const std::string& title, int width_px, int height_px)
    : impl_(std::make_unique<Impl>(title, width_px, height_px)) {}
Window::Window(Window&&) noexcept = default;
Window& Window::operator=(Window&&) noexcept = default;
Window::~Window() = default;

std::vector<InputEvent> Window::events(int wait_ms) {
  return impl_->events(wait_ms);
}

void Window::show(Canvas& canvas) {
  impl_->show(canvas);
}

std::string Window::driver() const {
  return video_driver();
}

// ---- gamepads: SDL's game controllers, whose buttons and sticks it knows by place ---------------

namespace {

static_assert(static_cast<int>(GamepadButton::kSouth) == SDL_CONTROLLER_BUTTON_A &&
              static_cast<int>(GamepadButton::kBack) == SDL_CONTROLLER_BUTTON_BACK &&
              static_cast<int>(GamepadButton::kStart) == SDL_CONTROLLER_BUTTON_START &&
              static_cast<int>(GamepadButton::kRightShoulder) ==
                  SDL_CONTROLLER_BUTTON_RIGHTSHOULDER);

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
    const Key key = key_of(static_cast<GamepadButton>(from.button));
    if (key == 0) return;
    InputEvent event;
    event.kind =
        from.state == SDL_PRESSED ? InputEvent::Kind::kKeyPressed : InputEvent::Kind::kKeyReleased;
    event.key = key;
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
