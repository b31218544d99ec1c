// Commands to a robot from a program outside: sent, repeated, answered, and the answer in words.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/station/command_key.h"
#include "host_sim/ground_station/telemetry/latest_telemetry.h"

namespace screed {

// A robot's answer to a command, in words: what it refused, in which state, and what to do about
// it.

struct CommandAnswer {
  uint8_t op = 0;
  uint8_t result = 0;  ///< 0: done
  uint16_t detail = 0;

  bool done() const { return result == 0; }
};

/// How the reader gives commands: by `screed send`, or by the keys of the monitor.
enum class CommandStyle : uint8_t { kProgram, kKeys };

/// "done", "refused: disarmed; arm first: screed send arm". `robot`: what it says of itself.
std::string answer_text(const CommandAnswer& answer, const LatestTelemetry& robot, uint64_t now_us,
                        CommandStyle style = CommandStyle::kProgram);

/// What stands behind "refused: "; empty when it is done.
std::string refusal_text(const CommandAnswer& answer, const LatestTelemetry& robot, uint64_t now_us,
                         CommandStyle style = CommandStyle::kProgram);

// A ground station's side of a link: heartbeats, signed commands repeated until they are answered,
// parameters. Knows the link and the schema; is given a clock, so that tests bring their own.
//
// Everything happens in pump(): what arrives is taken, what is due is sent. Nothing else waits.

struct SessionOptions {
  CommandKey key = test_key();
  /// This is the ground station: its heartbeats keep the robot going, their end stops it.
  bool heartbeats = true;
  /// Told of every frame that arrives.
  std::function<void(const LinkFrame&)> on_frame;
  /// Microseconds, rising.
  std::function<uint64_t()> clock;
  /// Called again and again while run(), read_parameter() and write_parameter() wait; ends them by
  /// throwing.
  std::function<void()> on_wait = nullptr;
};

class CommandSession {
 public:
  /// Robots take a ground station for lost after 0.5 s.
  static constexpr uint64_t kHeartbeat_us = 200'000;
  /// Commands go at most four times a second.
  static constexpr uint64_t kRepeat_us = 300'000;
  static constexpr int kMaxAttempts = 8;

  /// The link must outlive this.
  CommandSession(Link& link, SessionOptions options);

  /// Takes what arrives, at most `wait` long, and sends what is due.
  void pump(std::chrono::milliseconds wait);

  /// The node of the robot that has the key: commands go to it, and its answers count.
  uint8_t node() const { return signer_.node(); }

  /// A heartbeat of the robot was heard: commands can be signed.
  bool ready() const { return signer_.ready(); }

  /// Signs and sends a command; one that is still waiting is given up. Before ready() the command
  /// waits for a heartbeat; it is given up as one that is not answered.
  void start(CommandOp op, uint32_t argument = 0);
  /// Likewise: stages the value of a parameter and commits it.
  void start_write(uint16_t index, int32_t value);
  /// A command is on its way.
  bool waiting() const { return waiting_; }
  /// A command that still waits is not repeated any more; the robot may have done it.
  void give_up() { waiting_ = false; }
  /// The answer to the command started last, once; nothing while waiting, or when none came.
  std::optional<CommandAnswer> take_answer();

  // These pump until there is an answer, or nothing for as long as a command is repeated.

  std::optional<CommandAnswer> run(CommandOp op, uint32_t argument = 0);
  /// The value as the robot has it. `answer` says what came of it.
  std::optional<int32_t> read_parameter(uint16_t index, std::optional<CommandAnswer>& answer);
  /// Stages the value and commits it: it is in force and stored when the answer is "done".
  std::optional<CommandAnswer> write_parameter(uint16_t index, int32_t value);

  /// Sends EMERGENCY_STOP three times: it needs no key and has no answer of its own. A command that
  /// still waits is given up: its repetition must not start the robot again.
  void emergency_stop();

 private:
  /// One step of waiting for an answer.
  void wait();
  void send_protected(CanFrame frame, uint8_t& counter);
  void send_command();
  void handle_frame(const CanFrame& frame);

  Link& link_;
  SessionOptions options_;
  CommandSigner signer_;
  std::vector<LinkFrame> frames_;
  uint64_t heartbeat_due_us_ = 0;
  uint8_t heartbeat_counter_ = 0;
  uint8_t stop_counter_ = 0;
  uint8_t stage_counter_ = 0;

  bool waiting_ = false;
  CommandOp op_{};
  uint32_t argument_ = 0;
  std::optional<CanFrame> command_;  ///< as signed; nothing before the first heartbeat
  uint16_t signed_ = 0;              ///< the counter in it
  std::optional<CanFrame> staged_;   ///< goes before each repetition of the command
  int attempts_ = 0;
  uint64_t repeat_due_us_ = 0;
  std::optional<CommandAnswer> answer_;
  std::map<uint16_t, int32_t> parameters_;  ///< as last reported by the robot
};

}  // namespace screed
