// The downlink scheduler and the contents of its frames.
#include "firmware/telemetry/telemetry.h"

#include "firmware/math/units.h"
#include "firmware/telemetry/e2e.h"

namespace screed {
namespace {

struct Schedule {
  uint16_t id;
  uint8_t period;  ///< ticks; 100 / period messages a second
  uint8_t first;   ///< tick of the first one: spreads the load
};

// In order of importance. A full tick delays the lower lines by one tick; 117 lines a second of 200
// possible, 2498 bytes.
constexpr Schedule kSchedule[kTelemetryMessages] = {
    {kIdHeartbeat, 20, 0}, {kIdAttitude, 4, 1},  {kIdEncoders, 5, 2},  {kIdMotors, 5, 3},
    {kIdLeveling, 10, 4},  {kIdOdometry, 10, 6}, {kIdAccelRaw, 10, 8}, {kIdGyroRaw, 10, 9},
    {kIdPower, 50, 14},    {kIdMagRaw, 50, 24},  {kIdBaro, 100, 34},   {kIdHealth, 50, 44},
};

uint8_t header_bits(uint8_t value) {
  return static_cast<uint8_t>(value << 4);
}

void put_vector(uint8_t* at, const int16_t (&vector)[3]) {
  for (const int16_t component : vector) {
    put_s16(at, component);
    at += 2;
  }
}

/// Turn rate in 0.01 degree/s; int16_t holds it up to 327 degrees/s.
int16_t centidegrees_per_s(YawRate rate) {
  return centidegrees_from_angle(rate);
}

// Fills size and data[2..]; the protection header is written afterwards.
SCREED_OUT_OF_LINE void fill(CanFrame& frame, const TelemetryView& view) {
  uint8_t* const payload = frame.data + kE2eHeaderSize;
  const SensorSample& sample = *view.sample;
  frame.size = 8;
  frame.data[1] = 0;
  switch (frame.id) {
    case kIdHeartbeat:
      frame.data[1] = header_bits(static_cast<uint8_t>(view.state));
      put_u16(payload, view.faults);
      payload[2] = view.link_alive ? 1 : 0;
      payload[3] = view.rejected_lines;
      frame.size = 6;
      break;
    case kIdAttitude:
      put_s16(payload, view.roll_cdeg);
      put_s16(payload + 2, view.pitch_cdeg);
      put_u16(payload + 4, view.heading_cdeg);
      break;
    case kIdLeveling:
      frame.data[1] = header_bits(static_cast<uint8_t>(view.leveling_state));
      payload[0] = static_cast<uint8_t>(view.algorithm);
      payload[1] = static_cast<uint8_t>(view.peaks & 0xFFU);
      put_s16(payload + 2, view.motion.speed_mm_per_s);
      put_s16(payload + 4, centidegrees_per_s(view.motion.yaw_rate));
      break;
    case kIdEncoders:
      put_u16(payload, sample.encoder_left);
      put_u16(payload + 2, sample.encoder_right);
      put_u16(payload + 4, kTickPeriod_us / 4);
      break;
    case kIdMotors:
      put_s16(payload, view.duty_left);
      put_s16(payload + 2, view.duty_right);
      payload[4] = sample.encoder_errors;
      frame.size = 7;
      break;
    case kIdOdometry:
      put_s16(payload, saturate_i16(view.x_mm));
      put_s16(payload + 2, saturate_i16(view.y_mm));
      put_u16(payload + 4, view.heading_cdeg);
      break;
    case kIdAccelRaw:
      put_vector(payload, sample.accel);
      break;
    case kIdGyroRaw:
      put_vector(payload, sample.gyro);
      break;
    case kIdMagRaw:
      put_vector(payload, sample.mag);
      break;
    case kIdPower: {
      const uint16_t load = static_cast<uint16_t>(sample.last_tick_us / (kTickPeriod_us / 100U));
      put_u16(payload, view.battery_mv);
      payload[2] = static_cast<uint8_t>(load > 255 ? 255 : load);
      frame.size = 5;
      break;
    }
    case kIdHealth:
      frame.data[1] = header_bits(sample.reset_cause);
      payload[0] = sample.chips_failing;
      payload[1] = sample.bus_errors;
      payload[2] = sample.radio_errors;
      put_u16(payload + 3, sample.last_tick_us);
      frame.size = 7;
      break;
    case kIdBaro:
    default: {
      const uint16_t from_zero =
          quotient_u16(static_cast<uint32_t>(abs_u16(sample.temperature)) * 5U, 24);
      // 1/4096 hPa = 25/64 Pa/16; 24 bits times 25 fit
      put_u32(payload, (static_cast<uint32_t>(sample.pressure) * 25U) >> 6);
      // 42.5 degC + raw/480, in 0.01 degC
      put_s16(payload + 4,
              static_cast<int16_t>(sample.temperature < 0 ? 4250 - from_zero : 4250 + from_zero));
      break;
    }
  }
}

}  // namespace

void Telemetry::acknowledge(uint8_t op, RequestResult result) {
  ack_op_ = op;
  ack_result_ = result;
}

void Telemetry::emit(CanFrame& frame, uint8_t& counter, RobotOutput& output) {
  e2e_protect(frame.id, counter, frame.data, frame.size);
  counter = static_cast<uint8_t>((counter + 1) & 0x0F);
  output.radio_out_count = static_cast<uint8_t>(
      output.radio_out_count + slcan_encode(frame, output.radio_out + output.radio_out_count));
}

void Telemetry::tick(const TelemetryView& view, RobotOutput& output) {
  output.radio_out_count = 0;
  if (!started_) {
    for (uint8_t i = 0; i < kTelemetryMessages; ++i) countdown_[i] = kSchedule[i].first;
    started_ = true;
  }

  CanFrame frame{};
  if (ack_op_ != 0) {
    frame.id = kIdCommandAck;
    frame.size = 4;
    frame.data[2] = ack_op_;
    frame.data[3] = static_cast<uint8_t>(ack_result_);
    emit(frame, ack_counter_, output);
    ack_op_ = 0;
  }
  uint16_t bit = 1;
  for (uint8_t i = 0; i < kTelemetryMessages; ++i, bit = static_cast<uint16_t>(bit << 1)) {
    // The countdown goes on while a line waits, so that a delay moves one line and not its
    // schedule.
    if (countdown_[i] == 0) {
      due_ = static_cast<uint16_t>(due_ | bit);
      countdown_[i] = kSchedule[i].period;
    }
    --countdown_[i];
    if ((due_ & bit) == 0 || output.radio_out_count + kSlcanLineMax > kRadioOutCapacity) continue;
    frame.id = kSchedule[i].id;
    fill(frame, view);
    emit(frame, counter_[i], output);
    due_ = static_cast<uint16_t>(due_ & ~bit);
  }
}

}  // namespace screed
