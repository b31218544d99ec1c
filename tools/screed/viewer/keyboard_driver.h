// Who drives: the line that says so, and the user at keyboard or gamepad.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/link/robot_pilot.h"
#include "host_sim/ground_station/station/ground_station.h"

namespace screed::viewer {

/// Who moves the robot.
struct Driver {
  enum class Kind : uint8_t {
    kAlgorithm,         ///< the firmware
    kKeyboard,          ///< the user of this viewer
    kGamepad,           ///< likewise
    kSimulatedStation,  ///< the run's own ground station, as the experiment file says
    kExternalStation,   ///< another program, over the radio
    kUnknownStation     ///< a ground station: a recording does not say which
  };

  Kind kind = Kind::kAlgorithm;
  std::string algorithm;       ///< its name, for kAlgorithm
  bool external_link = false;  ///< kAlgorithm, supervised by another program's heartbeats
  bool replay = false;         ///< of a recorded run

  bool operator==(const Driver&) const = default;
};

/// The terrain as a user calls it: "soft soil (dry_sand)". model: of the section [map].
std::string terrain_name(const std::string& model, const std::string& soil);

/// "hill_sensing drives on rigid ground, seed 1".
std::string subtitle_of(const Driver& driver, const std::string& terrain, uint64_t seed);

// The user at the keyboard or gamepad as the robot's ground station: takes over from the simulated
// one, over the same radio, with the same signed commands and heartbeats as `screed monitor` sends.
//
// Nothing is sent before the user takes over, so that a run that is only watched is the run that
// nobody watched. What is sent is part of the recorded samples, as from any ground station.

class KeyboardDriver : public GroundPort, private Link {
 public:
  /// `algorithm`: the one in force, a LevelingAlgorithm. `beside`: another port at the same end of
  /// the radio; may be null, must outlive this.
  KeyboardDriver(const CommandKey& key, int algorithm, GroundPort* beside = nullptr);

  /// See RobotPilot.
  void drive(const DriveCommand& command, bool gamepad = false);
  void hand_back() { pilot_.hand_back(); }
  void emergency_stop() { pilot_.emergency_stop(); }
  void clear_fault() { pilot_.clear_fault(); }

  bool drives() const { return pilot_.drives(); }
  /// One line for the user; empty while there is nothing to say.
  std::string description() const;
  /// Who moves the robot, as far as the radio tells.
  Driver driver() const;

  void send(std::span<const uint8_t> bytes) override;
  std::vector<uint8_t> receive() override;

 private:
  void receive(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) override;
  bool send(const CanFrame& frame) override;
  const LinkStatus& status() const override { return status_; }
  const std::string& name() const override { return name_; }

  uint64_t now_us() const;
  void listen_beside(std::span<const uint8_t> bytes);

  uint64_t ticks_ = 0;
  int first_algorithm_;
  RobotPilot pilot_;
  GroundPort* beside_;
  bool gamepad_ = false;
  bool external_ = false;  ///< another program sends heartbeats

  SlcanParser parser_;
  SlcanParser beside_parser_;
  std::vector<LinkFrame> arrived_;
  std::vector<uint8_t> to_send_;
  LinkStatus status_;
  std::string name_ = "keyboard";
};

}  // namespace screed::viewer
