// What keys mean.
#include "tools/screed/viewer/input.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "host_sim/core/errors.h"
#include "tools/screed/cli/number_text.h"

namespace screed::viewer {
namespace {

struct NamedKey {
  const char* name;
  Key key;
};
constexpr std::array<NamedKey, 9> kNamedKeys = {{{"Left", kKeyLeft},
                                                 {"Right", kKeyRight},
                                                 {"Up", kKeyUp},
                                                 {"Down", kKeyDown},
                                                 {"Home", kKeyHome},
                                                 {"End", kKeyEnd},
                                                 {"Escape", kKeyEscape},
                                                 {"Backspace", kKeyBackspace},
                                                 {"Space", ' '}}};

constexpr std::array<double, 11> kPaces = {0.1, 0.25, 0.5,  1.0,  2.0, 4.0,
                                           8.0, 16.0, 32.0, 64.0, 0.0};
constexpr double kSlow = 0.35;
constexpr double kJump_s = 1.0;
constexpr double kFarJump_s = 10.0;

const std::vector<HelpLine> kCommonHelp = {
    {"Space", "pause, go on"},
    {".", "one control tick (10 ms), then pause"},
    {"+   \u2212", "faster, slower"},
    {"wheel, drag", "zoom, move the ground"},
    {"0", "show the whole bed"},
    {"F", "follow the robot"},
    {"M   1 2 3", "shade by height, slope, change of height"},
    {"T", "driven path on, off"},
    {"P", "save a picture of this window"},
    {"R", "Start and stop recording PNG frames"},
};

const std::vector<HelpLine> kLiveHelp = {
    {"arrows", "drive: the keyboard takes over (Shift: slowly)"},
    {"Backspace", "the algorithm drives again"},
    {"C", "clear a fault"},
    {"Q, Esc", "end the run and save it"},
};

const std::vector<HelpLine> kRecordedHelp = {
    {"\u2190   \u2192", "back, on by 1 s (Shift: 10 s)"},
    {"Home, End", "to the begin, to the end"},
    {"timeline", "click or drag: to that time"},
    {"Q, Esc", "close"},
};

std::vector<HelpLine> joined(const std::vector<HelpLine>& first,
                             const std::vector<HelpLine>& second) {
  std::vector<HelpLine> lines = first;
  lines.insert(lines.end(), second.begin(), second.end());
  return lines;
}

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
  if (key == kKeyUp) up_ = held;
  if (key == kKeyDown) down_ = held;
  if (key == kKeyLeft) left_ = held;
  if (key == kKeyRight) right_ = held;
}

void Controls::key_down(Key key, bool shift) {
  slow_ = shift;
  switch (key) {
    case ' ':
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
    case 'p':
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

double Controls::forward() const {
  return (slow_ ? kSlow : 1.0) * ((up_ ? 1.0 : 0.0) - (down_ ? 1.0 : 0.0));
}

double Controls::left() const {
  return (slow_ ? kSlow : 1.0) * ((left_ ? 1.0 : 0.0) - (right_ ? 1.0 : 0.0));
}

std::string Controls::pace_text() const {
  if (pace == 0.0) return "max";
  char text[32];
  std::snprintf(text, sizeof text, "\u00d7 %g", pace);
  return text;
}

const std::vector<HelpLine>& Controls::help_lines() const {
  static const std::vector<HelpLine> live = joined(kCommonHelp, kLiveHelp);
  static const std::vector<HelpLine> recorded = joined(kCommonHelp, kRecordedHelp);
  return recorded_ ? recorded : live;
}

}  // namespace screed::viewer
