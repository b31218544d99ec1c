// Reads a board's wiring.
#include "host_sim/devices/mcu/wiring.h"

#include <charconv>
#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/ini_file.h"

namespace screed::mcu {
namespace {

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

bool parse_pin(const std::string& text, PinName& pin) {
  if (text.size() != 3 || text[0] != 'P' || text[1] < 'B' || text[1] > 'F' || text[2] < '0' ||
      text[2] > '7') {
    return false;
  }
  pin = {text[1], static_cast<std::uint8_t>(text[2] - '0')};
  return true;
}

bool parse_pwm(const std::string& text, PinName& pin) {
  return parse_pin(text, pin) && (pin == PinName{'B', 5} || pin == PinName{'B', 6});
}

bool parse_led(const std::string& text, Wiring::Led& led) {
  const std::vector<std::string> words = words_of(text);
  if (words.size() != 2 || !parse_pin(words[0], led.pin)) return false;
  led.lit_high = words[1] == "high";
  return led.lit_high || words[1] == "low";
}

bool parse_axes(const std::string& text, std::array<Wiring::Axis, 3>& axes) {
  const std::vector<std::string> words = words_of(text);
  if (words.size() != 3) return false;
  unsigned seen = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const bool reversed = words[i][0] == '-';
    const std::string name = words[i].substr(reversed ? 1 : 0);
    if (name != "x" && name != "y" && name != "z") return false;
    axes.at(i) = {static_cast<std::uint8_t>(name[0] - 'x'), reversed};
    seen |= 1U << axes.at(i).index;
  }
  return seen == 7;
}

template <class Number>
bool parse_number(const std::string& text, Number& value, Number min, Number max) {
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  return result.ec == std::errc() && result.ptr == end && value >= min && value <= max;
}

bool parse_chips(const std::string& text, bool& has_barometer) {
  has_barometer = text == "LSM303D L3GD20H LPS25H";
  return has_barometer || text == "LSM303D L3GD20H";
}

struct Key {
  const char* section;
  const char* name;
  const char* allowed;
  std::function<bool(const std::string&, Wiring&)> set;
};

const std::vector<Key>& keys() {
  constexpr const char* kPin = "a pin as PB5";
  constexpr const char* kPwm = "PB5 (OC1A) or PB6 (OC1B)";
  constexpr const char* kLed = "a pin and the level that lights the LED, as PC7 high";
  static const std::vector<Key> table = {
      {"motors", "left_pwm", kPwm,
       [](auto& t, Wiring& w) { return parse_pwm(t, w.motors[0].pwm); }},
      {"motors", "left_direction", kPin,
       [](auto& t, Wiring& w) { return parse_pin(t, w.motors[0].direction); }},
      {"motors", "right_pwm", kPwm,
       [](auto& t, Wiring& w) { return parse_pwm(t, w.motors[1].pwm); }},
      {"motors", "right_direction", kPin,
       [](auto& t, Wiring& w) { return parse_pin(t, w.motors[1].direction); }},
      {"encoders", "wiring", "plain or xored",
       [](auto& t, Wiring& w) {
         w.xored = t == "xored";
         return w.xored || t == "plain";
       }},
      {"encoders", "left_a", kPin,
       [](auto& t, Wiring& w) { return parse_pin(t, w.encoders[0].a); }},
      {"encoders", "left_b", kPin,
       [](auto& t, Wiring& w) { return parse_pin(t, w.encoders[0].b); }},
      {"encoders", "right_a", kPin,
       [](auto& t, Wiring& w) { return parse_pin(t, w.encoders[1].a); }},
      {"encoders", "right_b", kPin,
       [](auto& t, Wiring& w) { return parse_pin(t, w.encoders[1].b); }},
      {"leds", "yellow", kLed, [](auto& t, Wiring& w) { return parse_led(t, w.leds[0]); }},
      {"leds", "green", kLed, [](auto& t, Wiring& w) { return parse_led(t, w.leds[1]); }},
      {"leds", "red", kLed, [](auto& t, Wiring& w) { return parse_led(t, w.leds[2]); }},
      {"battery", "adc_channel", "an integer 0..7",
       [](auto& t, Wiring& w) { return parse_number(t, w.adc_channel, 0, 7); }},
      {"battery", "divider", "a number 1..20",
       [](auto& t, Wiring& w) { return parse_number(t, w.battery_divider, 1.0, 20.0); }},
      {"imu", "chips", "LSM303D L3GD20H LPS25H, or LSM303D L3GD20H",
       [](auto& t, Wiring& w) { return parse_chips(t, w.has_barometer); }},
      {"imu", "axes", "x, y and z in some order, each perhaps with a minus sign",
       [](auto& t, Wiring& w) { return parse_axes(t, w.axes); }},
  };
  return table;
}

}  // namespace

Wiring read_wiring(const std::filesystem::path& path) {
  Wiring wiring{};
  std::set<const Key*> seen;
  for (const IniEntry& entry : read_ini_file(path)) {
    const std::string where = path.string() + ":" + std::to_string(entry.line) + ": ";
    const Key* found = nullptr;
    for (const Key& key : keys()) {
      if (entry.section == key.section && entry.key == key.name) found = &key;
    }
    if (found == nullptr) {
      throw InputError(where + "unknown key '" + entry.key + "' in [" + entry.section + "]");
    }
    if (!found->set(entry.value, wiring)) {
      throw InputError(where + "[" + entry.section + "] " + entry.key + " = '" + entry.value +
                       "' is not allowed; expected " + found->allowed);
    }
    seen.insert(found);
  }
  for (const Key& key : keys()) {
    if (!seen.contains(&key)) {
      throw InputError(path.string() + ": [" + key.section + "] " + key.name + " is missing");
    }
  }
  return wiring;
}

}  // namespace screed::mcu
