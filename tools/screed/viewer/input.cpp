// What keys and sticks mean.
#include "tools/screed/viewer/input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "host_sim/core/errors.h"
#include "tools/screed/cli/number_option.h"

namespace screed::viewer {

Key key_of(GamepadButton button) {
  for (const GamepadMapping& mapping : kGamepadMapping) {
    if (mapping.button == button) return mapping.key;
  }
  return 0;
}

double stick_value(int raw) {
  constexpr double kFull = 32767.0;
  constexpr double kDeadZone = 1.0 / 6.0;
  const double value = std::clamp(raw / kFull, -1.0, 1.0);
  const double beyond = (std::abs(value) - kDeadZone) / (1.0 - kDeadZone);
  return beyond <= 0.0 ? 0.0 : std::copysign(beyond, value);
}

namespace {

struct NamedKey {
  const char* name;
  Key key;
};
constexpr std::array<NamedKey, 10> kNamedKeys = {{{"Left", kKeyLeft},
                                                  {"Right", kKeyRight},
                                                  {"Up", kKeyUp},
                                                  {"Down", kKeyDown},
                                                  {"Home", kKeyHome},
                                                  {"End", kKeyEnd},
                                                  {"Escape", kKeyEscape},
                                                  {"Backspace", kKeyBackspace},
                                                  {"F12", kKeyF12},
                                                  {"Space", ' '}}};

constexpr std::array<double, 11> kPaces = {0.1, 0.25, 0.5,  1.0,  2.0, 4.0,
                                           8.0, 16.0, 32.0, 64.0, 0.0};
constexpr double kSlow = 0.35;
constexpr double kJump_s = 1.0;
constexpr double kFarJump_s = 10.0;

const std::vector<HelpLine> kCommonHelp = {
    {".", "one control tick (10 ms), then pause"},
    {"+   \u2212", "faster, slower"},
    {"wheel, drag", "zoom, move the ground"},
    {"0", "show the whole bed"},
    {"F", "follow the robot"},
    {"M   1 2 3", "shade by height, slope, change of height"},
    {"T", "driven path on, off"},
    {"F12", "save a picture of this window"},
    {"R", "start, stop recording PNG frames"},
};

const std::vector<HelpLine> kLiveHelp = {
    {kEmergencyStopKeyName, "EMERGENCY STOP of the robot"},
    {"P", "pause, go on"},
    {"arrows", "drive: the keyboard takes over (Shift: slowly)"},
    {"Backspace", "the algorithm drives again"},
    {"C", "clear a fault or emergency stop, drive on"},
    {"Q, Esc", "end the run and save it"},
};

const std::vector<HelpLine> kRecordedHelp = {
    {"Space, P", "pause, go on"},
    {"\u2190   \u2192", "back, on by 1 s (Shift: 10 s)"},
    {"Home, End", "to the start, to the end"},
    {"timeline", "click or drag: to that time"},
    {"Q, Esc", "close"},
};

}  // namespace

ScriptedKey parse_scripted_key(const std::string& text) {
  const auto fail = [&]() {
    return InputError("--key-script = '" + text +
                      "' is not allowed; expected KEY@SECONDS or KEY@FROM-TO, as m@2 or Up@3-5.5");
  };
  const size_t at = text.rfind('@');
  if (at == std::string::npos || at == 0) throw fail();
  const std::string name = text.substr(0, at);
  ScriptedKey scripted;
  const auto* const known = std::find_if(kNamedKeys.begin(), kNamedKeys.end(),
                                         [&](const NamedKey& named) { return name == named.name; });
  if (known != kNamedKeys.end()) {
    scripted.key = known->key;
  } else if (name.size() == 1 && name[0] > ' ' && name[0] < 127) {
    scripted.key = name[0] >= 'A' && name[0] <= 'Z' ? name[0] - 'A' + 'a' : name[0];
  } else {
    throw fail();
  }
  // Behind a first digit, which is no sign and no exponent's: "3-5", "1e-3", "1e-3-5".
  const std::string times = text.substr(at + 1);
  size_t minus = times.find('-', 1);
  if (minus != std::string::npos && (times[minus - 1] == 'e' || times[minus - 1] == 'E')) {
    minus = times.find('-', minus + 1);
  }
  constexpr double kTap_s = 0.05;
  constexpr double kMax_s = 1e6;
  const auto from_s = finite_number<double>(times.substr(0, minus));
  const auto to_s = minus == std::string::npos ? from_s.value_or(0.0) + kTap_s
                                               : finite_number<double>(times.substr(minus + 1));
  if (!from_s || !to_s || *from_s < 0.0 || *to_s < *from_s || *to_s > kMax_s + kTap_s) throw fail();
  scripted.from_s = *from_s;
  scripted.to_s = *to_s;
  return scripted;
}

std::vector<InputEvent> scripted_events(const std::vector<ScriptedKey>& script, double after_s,
                                        double until_s) {
  std::vector<InputEvent> events;
  const auto add = [&](double time_s, InputEvent::Kind kind, Key key) {
    if (time_s <= after_s || time_s > until_s) return;
    InputEvent event;
    event.kind = kind;
    event.key = key;
    events.push_back(event);
  };
  for (const ScriptedKey& key : script) {
    add(key.from_s, InputEvent::Kind::kKeyPressed, key.key);
    add(key.to_s, InputEvent::Kind::kKeyReleased, key.key);
  }
  return events;
}

Controls::Controls(bool recorded, double first_pace) : pace(first_pace), recorded_(recorded) {}

void Controls::change_pace(bool faster) {
  // 0, as fast as it goes, stands above all.
  const auto above = [](double a, double b) { return b != 0.0 && (a == 0.0 || a > b); };
  if (faster) {
    for (const double next : kPaces) {
      if (above(next, pace)) {
        pace = next;
        return;
      }
    }
  } else {
    for (auto next = kPaces.rbegin(); next != kPaces.rend(); ++next) {
      if (above(pace, *next)) {
        pace = *next;
        return;
      }
    }
  }
}

void Controls::drive_key(Key key, bool held) {
  if (held && key >= kKeyLeft && key <= kKeyDown) driven_by_gamepad_ = false;
  if (key == kKeyUp) up_ = held;
  if (key == kKeyDown) down_ = held;
  if (key == kKeyLeft) left_ = held;
  if (key == kKeyRight) right_ = held;
}

void Controls::key_down(Key key, bool shift) {
  slow_ = shift;
  // No robot listens in a recording, where this is the key that players pause with.
  if (key == kKeyEmergencyStop && !recorded_) {
    emergency_stop = true;
    return;
  }
  switch (key) {
    case ' ':
    case 'p':
      paused = !paused;
      break;
    case '.':
      paused = true;
      ++steps;
      break;
    case '+':
    case '=':
      change_pace(true);
      break;
    case '-':
      change_pace(false);
      break;
    case '0':
      fit = true;
      follow = false;
      break;
    case 'f':
      follow = !follow;
      break;
    case 'm':
      shading = static_cast<Shading>((static_cast<size_t>(shading) + 1) % kShadings);
      break;
    case '1':
    case '2':
    case '3':
      shading = static_cast<Shading>(key - '1');
      break;
    case 't':
      trail = !trail;
      break;
    case kKeyF12:
      screenshot = true;
      break;
    case 'r':
      recording = !recording;
      break;
    case 'h':
      help = !help;
      break;
    case 'q':
    case kKeyEscape:
      if (help && key == kKeyEscape) {
        help = false;
      } else {
        closed = true;
      }
      break;
    case 'c':
      clear_fault = true;
      break;
    case kKeyBackspace:
      hand_back = true;
      break;
    case kKeyHome:
      to_share = 0.0;
      break;
    case kKeyEnd:
      to_share = 1.0;
      break;
    case kKeyLeft:
    case kKeyRight:
      if (recorded_) {
        const double by = shift ? kFarJump_s : kJump_s;
        jump_s = jump_s.value_or(0.0) + (key == kKeyLeft ? -by : by);
      }
      drive_key(key, true);
      break;
    default:
      drive_key(key, true);
      break;
  }
}

void Controls::key_up(Key key) {
  drive_key(key, false);
}

void Controls::gamepad_event(const InputEvent& event) {
  switch (event.kind) {
    case InputEvent::Kind::kGamepadAdded:
      gamepad_ = event.name;
      stick_ = {};
      break;
    case InputEvent::Kind::kGamepadRemoved:
      // Whoever pulls the plug does not want the robot to drive on.
      gamepad_.clear();
      stick_ = {};
      break;
    default:
      (event.axis == GamepadAxis::kDrive ? stick_.forward : stick_.left) = event.amount;
      if (stick_.held()) driven_by_gamepad_ = true;
      break;
  }
}

double Controls::forward() const {
  const double keys = (slow_ ? kSlow : 1.0) * ((up_ ? 1.0 : 0.0) - (down_ ? 1.0 : 0.0));
  return std::clamp(keys + stick_.forward, -1.0, 1.0);
}

double Controls::left() const {
  const double keys = (slow_ ? kSlow : 1.0) * ((left_ ? 1.0 : 0.0) - (right_ ? 1.0 : 0.0));
  return std::clamp(keys + stick_.left, -1.0, 1.0);
}

std::string Controls::pace_text() const {
  if (pace == 0.0) return "max";
  char text[32];
  std::snprintf(text, sizeof text, "\u00d7 %g", pace);
  return text;
}

std::vector<HelpLine> Controls::help_lines() const {
  std::vector<HelpLine> lines = recorded_ ? kRecordedHelp : kLiveHelp;
  lines.insert(lines.end(), kCommonHelp.begin(), kCommonHelp.end());
  if (recorded_) return lines;
  if (gamepad_.empty()) {
    lines.push_back({"gamepad", "drives as well: plug one in"});
    return lines;
  }
  lines.push_back({"left stick", "drive: the gamepad takes over"});
  for (const GamepadMapping& mapping : kGamepadMapping) {
    lines.push_back({std::string("button ") + mapping.name, mapping.what});
  }
  return lines;
}

std::string Controls::key_hint() const {
  if (recorded_) return "H  keys";
  return std::string("H  keys    ") + kEmergencyStopKeyName + "  emergency stop";
}

}  // namespace screed::viewer
