// Words for who drives where, and a pilot over the simulated radio, stepped by the simulation's
// ticks.
#include "tools/screed/viewer/keyboard_driver.h"

#include <span>

#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "hal/sample.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "schema/class_values.h"

namespace screed::viewer {
namespace {

std::string name_of(const Driver& driver) {
  switch (driver.kind) {
    case Driver::Kind::kAlgorithm:
      break;
    case Driver::Kind::kKeyboard:
      return "the keyboard";
    case Driver::Kind::kGamepad:
      return "the gamepad";
    case Driver::Kind::kSimulatedStation:
      return "the simulated ground station";
    case Driver::Kind::kExternalStation:
      return "an external ground station";
    case Driver::Kind::kUnknownStation:
      return "a ground station";
  }
  return driver.algorithm + (driver.external_link ? " (external ground station)" : "");
}

}  // namespace

std::string terrain_name(const std::string& model, const std::string& soil) {
  if (model == "rigid") return "rigid ground";
  if (model == "scm") return "soft soil" + (soil.empty() ? "" : " (" + soil + ")");
  if (model == "static_particles") return "fixed particles";
  return model;
}

std::string subtitle_of(const Driver& driver, const std::string& terrain, uint64_t seed) {
  std::string words = driver.replay ? "replay: " : "";
  words += name_of(driver);
  words += " drives on ";
  words += terrain;
  words += ", seed ";
  words += std::to_string(seed);
  return words;
}

namespace {

constexpr int kDriveAlgorithm = static_cast<int>(message::LevelingAlgorithm::kDrive);

std::string algorithm_name(int algorithm) {
  static const SignalInfo& signal = *find_signal("leveling.algorithm").signal;
  const char* const name = signal.value_name(algorithm);
  return name == nullptr ? "an unknown algorithm" : name;
}

}  // namespace

KeyboardDriver::KeyboardDriver(const CommandKey& key, int algorithm, GroundPort* beside)
    : first_algorithm_(algorithm),
      pilot_(static_cast<Link&>(*this), {key, algorithm, [this] { return now_us(); }, {}}),
      beside_(beside) {}

uint64_t KeyboardDriver::now_us() const {
  return ticks_ * kTickPeriod_us;
}

void KeyboardDriver::drive(const DriveCommand& command, bool gamepad) {
  gamepad_ = gamepad;
  pilot_.drive(command);
}

std::string KeyboardDriver::description() const {
  std::string more = pilot_.description();
  if (!more.empty() || !pilot_.in_control()) return more;
  return gamepad_ ? "the gamepad drives" : "the keyboard drives";
}

Driver KeyboardDriver::driver() const {
  Driver driver;
  driver.external_link = external_ && !pilot_.begun();
  const int algorithm =
      pilot_.reported_algorithm().value_or(static_cast<uint8_t>(first_algorithm_));
  if (algorithm != kDriveAlgorithm) {
    driver.algorithm = algorithm_name(algorithm);
  } else if (drives()) {
    driver.kind = gamepad_ ? Driver::Kind::kGamepad : Driver::Kind::kKeyboard;
  } else {
    driver.kind = external_ ? Driver::Kind::kExternalStation : Driver::Kind::kSimulatedStation;
  }
  return driver;
}

/// A program that sends heartbeats is a ground station.
void KeyboardDriver::listen_beside(std::span<const uint8_t> bytes) {
  CanFrame frame{};
  for (const uint8_t byte : bytes) {
    if (beside_parser_.feed(byte, frame) && frame.id == kIdGroundHeartbeat) external_ = true;
  }
}

void KeyboardDriver::send(std::span<const uint8_t> bytes) {
  if (beside_ != nullptr) beside_->send(bytes);
  CanFrame frame{};
  for (const uint8_t byte : bytes) {
    if (!parser_.feed(byte, frame)) continue;
    if (pilot_.begun()) {
      LinkFrame arrived;
      arrived.time_us = now_us();
      arrived.frame = frame;
      arrived_.push_back(arrived);
    } else if (check_frame(frame) == FrameFault::kNone) {
      pilot_.note_frame(frame);
    }
  }
}

std::vector<uint8_t> KeyboardDriver::receive() {
  ++ticks_;
  std::vector<uint8_t> bytes;
  if (beside_ != nullptr) bytes = beside_->receive();
  listen_beside(bytes);
  pilot_.pump(std::chrono::milliseconds(0));
  bytes.insert(bytes.end(), to_send_.begin(), to_send_.end());
  to_send_.clear();
  return bytes;
}

void KeyboardDriver::receive(std::chrono::milliseconds /*wait*/, std::vector<LinkFrame>& frames) {
  frames.insert(frames.end(), arrived_.begin(), arrived_.end());
  arrived_.clear();
}

bool KeyboardDriver::send(const CanFrame& frame) {
  uint8_t line[kSlcanLineMax];
  const uint8_t length = slcan_encode(frame, line);
  to_send_.insert(to_send_.end(), line, line + length);
  return true;
}

}  // namespace screed::viewer
