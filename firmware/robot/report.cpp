// What the robot says of itself: each message from what its parts know in this tick.
#include "firmware/math/units.h"
#include "firmware/protocol/e2e.h"
#include "firmware/robot/robot.h"

namespace screed {
namespace {

/// Turn rate in 0.01 degree/s; int16_t holds it up to 327 degrees/s.
int16_t centidegrees_per_s(YawRate rate) {
  return centidegrees_from_angle(rate);
}

/// 0..35999, as 16 bits.
SCREED_OUT_OF_LINE int16_t heading_cdeg(Angle heading) {
  return static_cast<int16_t>((static_cast<uint32_t>(static_cast<uint16_t>(heading)) * 36000U) >>
                              16);
}

// Six messages are three numbers of 16 bits each: their code is in the image once.
SCREED_OUT_OF_LINE void set_words(CanFrame& frame, int16_t first, int16_t second, int16_t third) {
  set(frame, message::AccelRaw{first, second, third});
}

void set_vector(CanFrame& frame, const int16_t (&vector)[3]) {
  set_words(frame, vector[0], vector[1], vector[2]);
}

}  // namespace

void Robot::fill(CanFrame& frame, const SensorSample& sample) {
  const RobotStatus& robot = state_.status;
  const UplinkCounts& uplink = state_.uplink;
  switch (e2e_data_id(frame.id)) {  // a byte, and no two messages have the same
    case e2e_data_id(kIdHeartbeat): {
      message::Heartbeat it{};
      it.state = static_cast<uint8_t>(robot.state);
      it.faults = supervisor_.reported_faults();
      it.link_alive = supervisor_.link_alive() ? 1 : 0;
      it.boot_epoch = gate_.boot_epoch();
      it.freshness = gate_.counter();
      set(frame, it);
      break;
    }
    case e2e_data_id(kIdAttitude):
      set_words(frame, centidegrees_from_angle(robot.angles.roll),
                centidegrees_from_angle(robot.angles.pitch), heading_cdeg(robot.angles.heading));
      break;
    case e2e_data_id(kIdLeveling): {
      message::Leveling it{};
      it.state = static_cast<uint8_t>(leveling_.state());
      it.algorithm = static_cast<uint8_t>(leveling_.algorithm());
      it.peaks = static_cast<uint8_t>(leveling_.peaks() & 0xFFU);
      it.speed = robot.motion.speed_mm_per_s;
      it.turn_rate = centidegrees_per_s(robot.motion.yaw_rate);
      set(frame, it);
      break;
    }
    case e2e_data_id(kIdEncoders):
      set_words(frame, static_cast<int16_t>(sample.encoder_left),
                static_cast<int16_t>(sample.encoder_right),
                static_cast<int16_t>(kTickPeriod_us / 4));  // ENCODERS.interval, 4 us a unit
      break;
    case e2e_data_id(kIdMotors):
      set(frame,
          message::Motors{static_cast<uint8_t>(slip_watch_.slips() ? 1 : 0),
                          static_cast<uint8_t>(slip_watch_.stuck() ? 1 : 0), robot.duty.duty_left,
                          robot.duty.duty_right, sample.encoder_errors});
      break;
    case e2e_data_id(kIdOdometry):
      set_words(frame, robot.place.mm[kX], robot.place.mm[kY], heading_cdeg(robot.angles.heading));
      break;
    case e2e_data_id(kIdPosition):
      set(frame, message::Position{robot.place.sigma[kX], robot.place.sigma[kY],
                                   attitude_.heading_sigma(), slip_watch_.travel_share()});
      break;
    case e2e_data_id(kIdAccelRaw):
      set_vector(frame, sample.imu.accel());
      break;
    case e2e_data_id(kIdGyroRaw):
      set_vector(frame, sample.imu.gyro());
      break;
    case e2e_data_id(kIdMagRaw):
      set_vector(frame, sample.imu.mag());
      break;
    case e2e_data_id(kIdPower): {
      const uint16_t load = static_cast<uint16_t>(sample.last_tick_us / (kTickPeriod_us / 100U));
      set(frame, message::Power{robot.battery_mv, static_cast<uint8_t>(load > 255 ? 255 : load)});
      break;
    }
    case e2e_data_id(kIdHealth): {
      message::Health it{};
      it.reset_cause = sample.reset_cause;
      it.conditions = static_cast<uint8_t>(
          sample.chips_failing | (!attitude_.ready() ? message::HealthConditions::kStarting : 0) |
          (attitude_.mag_disturbed() ? message::HealthConditions::kMagDisturbed : 0));
      it.i2c_errors = sample.bus_errors;
      it.uart_errors = sample.radio_errors;
      it.longest_tick = state_.longest_tick_us;
      state_.longest_tick_us = 0;
      set(frame, it);
      break;
    }
    case e2e_data_id(kIdLink): {
      message::Link it{};
      it.frames_received = uplink.frames_received;
      it.lines_rejected = parser_.rejected();
      it.frames_rejected = uplink.rejected_frames;
      it.commands_rejected = gate_.refused();
      // The ground station sends five heartbeats a second; LINK goes once a second: 20 % each.
      const uint8_t heard =
          static_cast<uint8_t>(uplink.ground_heartbeats - state_.heartbeats_before);
      it.quality = heard < 5 ? static_cast<uint8_t>(20U * heard) : static_cast<uint8_t>(100);
      state_.heartbeats_before = uplink.ground_heartbeats;
      set(frame, it);
      break;
    }
    case e2e_data_id(kIdTime):
      // Ticks are whole milliseconds.
      state_.time_ms += quotient_u32(sample.time_us - state_.time_us, 1000);
      state_.time_us = sample.time_us;
      set(frame, message::Time{state_.time_ms, uplink.ground_time_ms});
      break;
    case e2e_data_id(kIdBaro):
    default:  // no other: whatever telemetry.cpp schedules has a case here
      set(frame, message::Baro{static_cast<uint32_t>(asr(sample.pressure, 4)), sample.temperature});
      break;
  }
}

void Robot::report(const SensorSample& sample, RobotOutput& output) {
  if (sample.last_tick_us > state_.longest_tick_us) state_.longest_tick_us = sample.last_tick_us;
  telemetry_.begin_tick(output);
  for (uint8_t message = 0; message < kTelemetryMessages; ++message) {
    if (!telemetry_.due(message, output)) continue;
    CanFrame frame;  // what is sent of it is written below
    frame.id = Telemetry::id(message);
    fill(frame, sample);
    telemetry_.send(frame, message, output);
  }
}

}  // namespace screed
