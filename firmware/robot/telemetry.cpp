// The downlink scheduler and the contents of its frames.
#include "firmware/robot/telemetry.h"

#include "firmware/math/units.h"
#include "firmware/protocol/e2e.h"
#include "hal/program_memory.h"

namespace screed {
namespace {

struct Schedule {
  uint16_t id;
  uint8_t period;  ///< ticks; 100 / period messages a second
  uint8_t first;   ///< tick of the first one: spreads the load
};

constexpr uint16_t kTick_ms = kTickPeriod_us / 1000;

/// A row: the message by its period in the schema.
template <typename Message>
constexpr Schedule every(uint8_t first) {
  static_assert(Message::kPeriod_ms % kTick_ms == 0 && Message::kPeriod_ms / kTick_ms <= UINT8_MAX,
                "periods are whole ticks, at most 255");
  return {Message::kId, static_cast<uint8_t>(Message::kPeriod_ms / kTick_ms), first};
}

// In order of importance; 121 lines a second of 200 possible, 2598 of the 2850 bytes of the budget.
const Schedule kSchedule[] SCREED_PROGRAM_MEMORY = {
    every<message::Heartbeat>(0), every<message::Attitude>(1), every<message::Encoders>(2),
    every<message::Motors>(3),    every<message::Leveling>(4), every<message::Odometry>(6),
    every<message::AccelRaw>(8),  every<message::GyroRaw>(9),  every<message::Power>(14),
    every<message::MagRaw>(24),   every<message::Baro>(34),    every<message::Health>(44),
    every<message::Link>(54),     every<message::Time>(64),    every<message::Position>(19),
};
static_assert(sizeof(kSchedule) / sizeof(kSchedule[0]) == kTelemetryMessages,
              "every message with a period has a row");

// A full packet (88) plus what one packet period earns (57).
constexpr uint8_t kMaxCredit = kRadioOutCapacity + Telemetry::kPacketBudget;

/// The alive counter of a message that is sent when there is something to say: by its class.
constexpr uint8_t urgent_counter(uint16_t id) {
  return static_cast<uint8_t>(kTelemetryMessages + (id >> 8));
}
static_assert(urgent_counter(kIdEvent) < kTelemetryMessages + kMessageClasses, "there is one");
static_assert(urgent_counter(kIdCommandAck) != urgent_counter(kIdParamValue) &&
                  urgent_counter(kIdParamValue) != urgent_counter(kIdEvent) &&
                  urgent_counter(kIdCommandAck) != urgent_counter(kIdEvent),
              "each has a counter of its own");

/// Turn rate in 0.01 degree/s; int16_t holds it up to 327 degrees/s.
int16_t centidegrees_per_s(YawRate rate) {
  return centidegrees_from_angle(rate);
}

/// 0..35999, as 16 bits.
SCREED_OUT_OF_LINE int16_t heading_cdeg(Angle heading) {
  return static_cast<int16_t>((static_cast<uint32_t>(static_cast<uint16_t>(heading)) * 36000U) >>
                              16);
}

// Fills size and data; the protection is written afterwards.
template <typename Message>
void set(CanFrame& frame, const Message& message) {
  frame.size = Message::kSize;
  message.pack(frame.data);
}

// Six messages are three numbers of 16 bits each: their code is in the image once.
SCREED_OUT_OF_LINE void set_words(CanFrame& frame, int16_t first, int16_t second, int16_t third) {
  set(frame, message::AccelRaw{first, second, third});
}

void set_vector(CanFrame& frame, const int16_t (&vector)[3]) {
  set_words(frame, vector[0], vector[1], vector[2]);
}

}  // namespace

void Telemetry::fill(CanFrame& frame, const TelemetryView& view) {
  const SensorSample& sample = *view.sample;
  const RobotStatus& robot = *view.robot;
  const UplinkCounts& uplink = *view.uplink;
  switch (e2e_data_id(frame.id)) {
    case e2e_data_id(kIdHeartbeat): {
      message::Heartbeat it{};
      it.state = static_cast<uint8_t>(robot.state);
      it.faults = view.faults;
      it.link_alive = view.link_alive ? 1 : 0;
      it.boot_epoch = view.boot_epoch;
      it.freshness = view.freshness;
      set(frame, it);
      break;
    }
    case e2e_data_id(kIdAttitude):
      set_words(frame, centidegrees_from_angle(robot.angles.roll),
                centidegrees_from_angle(robot.angles.pitch), heading_cdeg(robot.angles.heading));
      break;
    case e2e_data_id(kIdLeveling): {
      message::Leveling it{};
      it.state = static_cast<uint8_t>(view.leveling_state);
      it.algorithm = static_cast<uint8_t>(view.algorithm);
      it.peaks = static_cast<uint8_t>(view.peaks & 0xFFU);
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
      set(frame, message::Motors{view.slip, view.stuck, robot.duty.duty_left, robot.duty.duty_right,
                                 sample.encoder_errors});
      break;
    case e2e_data_id(kIdOdometry):
      set_words(frame, robot.place.mm[kX], robot.place.mm[kY], heading_cdeg(robot.angles.heading));
      break;
    case e2e_data_id(kIdPosition):
      set(frame, message::Position{robot.place.sigma[kX], robot.place.sigma[kY], view.sigma_heading,
                                   view.travel_share});
      break;
    case e2e_data_id(kIdAccelRaw):
      set_vector(frame, sample.accel);
      break;
    case e2e_data_id(kIdGyroRaw):
      set_vector(frame, sample.gyro);
      break;
    case e2e_data_id(kIdMagRaw):
      set_vector(frame, sample.mag);
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
          sample.chips_failing | (view.starting ? message::HealthConditions::kStarting : 0) |
          (view.mag_disturbed ? message::HealthConditions::kMagDisturbed : 0));
      it.i2c_errors = sample.bus_errors;
      it.uart_errors = sample.radio_errors;
      it.longest_tick = longest_tick_us_;
      longest_tick_us_ = 0;
      set(frame, it);
      break;
    }
    case e2e_data_id(kIdLink): {
      message::Link it{};
      it.frames_received = uplink.frames_received;
      it.lines_rejected = view.rejected_lines;
      it.frames_rejected = uplink.rejected_frames;
      it.commands_rejected = view.rejected_commands;
      // The ground station sends five heartbeats a second; LINK goes once a second: 20 % each.
      const uint8_t heard = static_cast<uint8_t>(uplink.ground_heartbeats - heartbeats_before_);
      it.quality = heard < 5 ? static_cast<uint8_t>(20U * heard) : static_cast<uint8_t>(100);
      heartbeats_before_ = uplink.ground_heartbeats;
      set(frame, it);
      break;
    }
    case e2e_data_id(kIdTime):
      // Ticks are whole milliseconds.
      time_ms_ += quotient_u32(sample.time_us - time_us_, 1000);
      time_us_ = sample.time_us;
      set(frame, message::Time{time_ms_, uplink.ground_time_ms});
      break;
    case e2e_data_id(kIdBaro):
    default:
      set(frame, message::Baro{static_cast<uint32_t>(asr(sample.pressure, 4)), sample.temperature});
      break;
  }
}

void Telemetry::queue(const CanFrame& frame) {
  if (queued_ == kQueue) return;
  queue_[(first_queued_ + queued_) % kQueue] = frame;
  ++queued_;
}

void Telemetry::emit(CanFrame& frame, uint8_t message, RobotOutput& output) {
  frame.id = exchange(frame.id);
  e2e_protect(frame.id, counter_[message], frame.data, frame.size);
  counter_[message] = static_cast<uint8_t>((counter_[message] + 1) & 0x0F);
  const uint8_t length = slcan_encode(frame, output.radio_out + output.radio_out_count);
  output.radio_out_count = static_cast<uint8_t>(output.radio_out_count + length);
  credit_ = static_cast<uint8_t>(credit_ - length);
}

bool Telemetry::room(const RobotOutput& output) const {
  return credit_ >= kSlcanLineMax && output.radio_out_count + kSlcanLineMax <= kRadioOutCapacity;
}

void Telemetry::tick(const TelemetryView& view, RobotOutput& output) {
  output.radio_out_count = 0;
  if (!started_) {
    for (uint8_t i = 0; i < kTelemetryMessages; ++i) {
      countdown_[i] = read_program_u8(&kSchedule[i].first);
    }
    started_ = true;
  }
  if (view.sample->last_tick_us > longest_tick_us_) longest_tick_us_ = view.sample->last_tick_us;

  const bool packet = next_packet_ == 0;
  next_packet_ = packet ? kPacketTicks - 1 : static_cast<uint8_t>(next_packet_ - 1);
  if (packet) {
    const uint8_t credit = static_cast<uint8_t>(credit_ + kPacketBudget);
    credit_ = credit < kMaxCredit ? credit : kMaxCredit;
    while (queued_ != 0 && room(output)) {
      CanFrame& frame = queue_[first_queued_];
      emit(frame, urgent_counter(frame.id), output);
      first_queued_ = (first_queued_ + 1U) % kQueue;
      --queued_;
    }
  }

  uint16_t bit = 1;
  for (uint8_t i = 0; i < kTelemetryMessages; ++i, bit = static_cast<uint16_t>(bit << 1)) {
    // The countdown goes on while a line waits, so that a delay moves one line and not its
    // schedule.
    if (countdown_[i] == 0) {
      due_ = static_cast<uint16_t>(due_ | bit);
      countdown_[i] = read_program_u8(&kSchedule[i].period);
    }
    --countdown_[i];
    if (!packet || (due_ & bit) == 0 || !room(output)) continue;
    CanFrame frame;  // fill() and emit() write what is sent of it
    frame.id = read_program_u16(&kSchedule[i].id);
    fill(frame, view);
    emit(frame, i, output);
    due_ = static_cast<uint16_t>(due_ & ~bit);
  }
}

}  // namespace screed
