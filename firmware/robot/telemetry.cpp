// The downlink's schedule.
#include "firmware/robot/telemetry.h"

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

}  // namespace

Telemetry::Telemetry(uint8_t robot_id) : OwnNode(robot_id) {
  for (uint8_t i = 0; i < kTelemetryMessages; ++i) {
    state_.countdown[i] = read_program_u8(&kSchedule[i].first);
  }
}

void Telemetry::queue(const CanFrame& frame) {
  if (state_.queued == kQueue) return;
  state_.queue[static_cast<uint8_t>(state_.first_queued + state_.queued) % kQueue] = frame;
  ++state_.queued;
}

void Telemetry::send(CanFrame& frame, uint8_t message, RobotOutput& output) {
  frame.id = exchange(frame.id);
  e2e_protect(frame.id, state_.counter[message], frame.data, frame.size);
  state_.counter[message] = static_cast<uint8_t>((state_.counter[message] + 1) & 0x0F);
  const uint8_t length = slcan_encode(frame, output.radio_out + output.radio_out_count);
  output.radio_out_count = static_cast<uint8_t>(output.radio_out_count + length);
  state_.credit = static_cast<uint8_t>(state_.credit - length);
}

bool Telemetry::room(const RobotOutput& output) const {
  return state_.credit >= kSlcanLineMax &&
         output.radio_out_count <= kRadioOutCapacity - kSlcanLineMax;
}

void Telemetry::begin_tick(RobotOutput& output) {
  output.radio_out_count = 0;
  if (!is_packet_tick()) {
    --state_.next_packet;
    return;
  }
  state_.next_packet = kPacketTicks - 1;
  const uint8_t credit = static_cast<uint8_t>(state_.credit + kPacketBudget);
  state_.credit = credit < kMaxCredit ? credit : kMaxCredit;
  while (state_.queued != 0 && room(output)) {
    CanFrame& frame = state_.queue[state_.first_queued];
    send(frame, urgent_counter(frame.id), output);
    state_.first_queued = (state_.first_queued + 1U) % kQueue;
    --state_.queued;
  }
}

bool Telemetry::due(uint8_t message, const RobotOutput& output) {
  // The countdown goes on while a line waits, so that a delay moves one line and not its schedule.
  uint8_t& countdown = state_.countdown[message];
  if (countdown == 0) {
    state_.waits[message] = true;
    countdown = read_program_u8(&kSchedule[message].period);
  }
  --countdown;
  const bool packet = state_.next_packet == kPacketTicks - 1;
  if (!packet || !state_.waits[message] || !room(output)) return false;
  state_.waits[message] = false;
  return true;
}

uint16_t Telemetry::id(uint8_t message) {
  return read_program_u16(&kSchedule[message].id);
}

}  // namespace screed
