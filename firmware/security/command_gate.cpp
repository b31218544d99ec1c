// Freshness, MAC and lock-out of commands.
#include "firmware/security/command_gate.h"

#include <string.h>

#include "firmware/math/fixed.h"

namespace screed {

SCREED_OUT_OF_LINE GateResult CommandGate::check(uint16_t can_id, const uint8_t* data) {
  if (!credentials_.key_set) return GateResult::kNoKey;
  if (locked_ticks_ != 0) return GateResult::kLockedOut;
  if (counter_ != 0 && memcmp(data, last_, kCommandSize) == 0) return GateResult::kRepeated;

  // 1 to 256 above the last one.
  const uint8_t steps = static_cast<uint8_t>(data[kCommandFreshnessOffset] -
                                             static_cast<uint8_t>(counter_ & 0xFFU) - 1U);
  if (counter_ > UINT16_MAX - 1U - steps) return GateResult::kUsedUp;
  const auto counter = static_cast<uint16_t>(counter_ + steps + 1U);
  uint8_t mac[kSipHashSize];
  command_mac(credentials_.key, can_id, credentials_.robot_id, credentials_.boot_epoch, counter,
              data, mac);
  // All bytes are looked at, so that the time tells nothing of the right ones.
  uint8_t wrong = 0;
  for (uint8_t i = 0; i < kCommandMacSize; ++i) {
    wrong = static_cast<uint8_t>(wrong | (mac[i] ^ data[kCommandMacOffset + i]));
  }
  if (wrong != 0) {
    ++refused_;
    ++bad_macs_;
    if (bad_macs_ == 1) bad_mac_decay_ticks_ = kBadMacDecayTicks;
    if (bad_macs_ == kMaxBadMacs) {
      bad_macs_ = 0;
      locked_ticks_ = kLockoutTicks;
    }
    return GateResult::kBadMac;
  }
  counter_ = counter;
  memcpy(last_, data, kCommandSize);
  return GateResult::kAccepted;
}

void CommandGate::tick() {
  if (locked_ticks_ != 0) --locked_ticks_;
  if (bad_macs_ == 0) return;
  if (--bad_mac_decay_ticks_ == 0) {
    --bad_macs_;
    bad_mac_decay_ticks_ = kBadMacDecayTicks;
  }
}

}  // namespace screed
