// Frames as robots send them, for tests of those who hear them.
#pragma once

#include <cstdint>

#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "host_sim/ground_station/link/link.h"

namespace screed {

inline constexpr uint64_t kStart_us = 1'700'000'000'000'000;

template <class Message>
LinkFrame frame_with(const Message& message, uint8_t counter, uint64_t time_us) {
  LinkFrame frame;
  frame.time_us = time_us;
  frame.frame = frame_of(message);
  e2e_protect(frame.frame.id, counter, frame.frame.data, frame.frame.size);
  return frame;
}

inline message::Attitude attitude(int16_t roll_cdeg, int16_t pitch_cdeg) {
  message::Attitude attitude{};
  attitude.roll = roll_cdeg;
  attitude.pitch = pitch_cdeg;
  attitude.heading = 9000;
  return attitude;
}

inline message::Heartbeat heartbeat(message::HeartbeatState state, uint16_t faults) {
  message::Heartbeat heartbeat{};
  heartbeat.state = static_cast<uint8_t>(state);
  heartbeat.faults = faults;
  heartbeat.boot_epoch = 7;
  return heartbeat;
}

}  // namespace screed
