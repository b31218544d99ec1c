// A Robot on its own: standing level with a well IMU, its tracks simulated as lags, and a ground
// station's frames to send.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "boards/a_star_32u4/board.h"
#include "firmware/protocol/e2e.h"
#include "firmware/robot/robot.h"
#include "host_sim/ground_station/station/command_key.h"
#include "tests/unit/firmware/control/simulated_track.h"

namespace screed {

class TestRobot {
 public:
  explicit TestRobot(const Parameters& parameters = {}, const CommandKey& key = test_key())
      : robot(kBoard, parameters, credentials_of(key)), signer(key) {
    CanFrame heard = frame_of(message::Heartbeat{0, 0, 0, kFirstBootEpoch, 0});
    heard.id = id_of_node(heard.id, signer.node());
    signer.handle_frame(heard);
    sample.imu.accel()[2] = 4098;
    sample.imu.mag()[1] = 1217;
    sample.imu.mag()[2] = -3013;
    sample.battery = 3932;  // 7.2 V
  }

  /// One tick of 10 ms; the bytes queued with send() arrive in it.
  void tick() {
    sample.time_us += kTickPeriod_us;
    sample.fresh = kFreshGyro | kFreshAccel | kFreshMag;
    sample.imu.gyro()[0] = sample.imu.gyro()[0] == 0 ? 1 : 0;
    if (heartbeats && ticks % 20 == 0) send(heartbeat());
    sample.radio_in_count = 0;
    while (!queue.empty() && sample.radio_in_count < kRadioInCapacity) {
      sample.radio_in[sample.radio_in_count++] = queue.front();
      queue.erase(queue.begin());
    }
    const auto counts_left = static_cast<int16_t>(
        left_encoder_sign * left.step(left_driver_stuck_at.value_or(output.duty_left), 7.2,
                                      left_blocked ? 1000.0 : 0.0));
    const int16_t counts_right = right.step(output.duty_right);
    sample.encoder_left = static_cast<uint16_t>(sample.encoder_left + counts_left);
    sample.encoder_right =
        static_cast<uint16_t>(sample.encoder_right + (right_encoder_dead ? 0 : counts_right));
    robot.tick(sample, output);
    ++ticks;
  }
  void run(int count) {
    for (int i = 0; i < count; ++i) tick();
  }
  /// Until the attitude is there, then armed and running.
  void start() {
    run(600);
    send(command(CommandOp::kArm));
    run(2);
    send(command(CommandOp::kRun));
    run(2);
  }

  CanFrame heartbeat() {
    return protect(frame_of(message::GroundHeartbeat{sample.time_us / 1000}), heartbeat_counter);
  }
  CanFrame command(CommandOp op, DriveArgument argument = {0, 0}) {
    return signer.sign(op, argument);
  }
  CanFrame emergency_stop() {
    uint8_t counter = 0;
    return protect(frame_of(message::EmergencyStop{}), counter);
  }
  static CanFrame protect(CanFrame frame, uint8_t& counter) {
    e2e_protect(frame.id, counter, frame.data, frame.size);
    counter = static_cast<uint8_t>((counter + 1) & 0x0F);
    return frame;
  }
  void send(const CanFrame& frame) {
    uint8_t line[kSlcanLineMax];
    const uint8_t length = slcan_encode(frame, line);
    queue.insert(queue.end(), line, line + length);
  }
  /// Runs until a command is answered, at most 10 ticks.
  std::optional<message::CommandAck> answer() {
    for (int i = 0; i < 10; ++i) {
      tick();
      SlcanParser parser;
      CanFrame frame{};
      for (uint8_t at = 0; at < output.radio_out_count; ++at) {
        if (parser.feed(output.radio_out[at], frame) &&
            frame.id == id_of_node(kIdCommandAck, signer.node())) {
          return message::CommandAck::unpack(frame.data);
        }
      }
    }
    return std::nullopt;
  }
  RobotState state() const { return robot.supervisor().state(); }

  Robot robot;
  SensorSample sample{};
  RobotOutput output{};
  CommandSigner signer;
  SimulatedTrack left;
  SimulatedTrack right;
  std::vector<uint8_t> queue;
  bool heartbeats = true;
  bool right_encoder_dead = false;
  bool left_blocked = false;
  int left_encoder_sign = 1;
  std::optional<int16_t> left_driver_stuck_at;  ///< duty
  uint8_t heartbeat_counter = 0;
  int ticks = 0;
};

}  // namespace screed
