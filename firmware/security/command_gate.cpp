// Freshness, MAC and lock-out of commands.
#include "firmware/security/command_gate.h"

#include <string.h>

#include "firmware/math/fixed.h"

namespace screed {

namespace {

/// All bytes are looked at, so that the time tells nothing of the right ones.
SCREED_OUT_OF_LINE bool same(const uint8_t* a, const uint8_t* b, uint8_t size) {
  uint8_t different = 0;
  for (uint8_t i = 0; i < size; ++i) different = static_cast<uint8_t>(different | (a[i] ^ b[i]));
  return different == 0;
}

}  // namespace

SCREED_OUT_OF_LINE GateResult CommandGate::check(uint16_t can_id, const uint8_t* data) {
  if (!credentials_.key_set) return GateResult::kNoKey;
  if (state_.locked_ticks != 0) return GateResult::kLockedOut;
  if (state_.counter != 0 && same(data, state_.last, kCommandSize)) return GateResult::kRepeated;

  // 1 to 256 above the last one.
  const uint8_t steps = static_cast<uint8_t>(data[kCommandFreshnessOffset] -
                                             static_cast<uint8_t>(state_.counter & 0xFFU) - 1U);
  if (state_.counter > UINT16_MAX - 1U - steps) return GateResult::kUsedUp;
  const auto counter = static_cast<uint16_t>(state_.counter + steps + 1U);
  uint8_t mac[kSipHashSize];
  command_mac(credentials_.key, can_id, credentials_.robot_id, credentials_.boot_epoch, counter,
              data, mac);
  if (!same(mac, data + kCommandMacOffset, kCommandMacSize)) {
    ++state_.refused;
    ++state_.bad_macs;
    if (state_.bad_macs == 1) state_.bad_mac_decay_ticks = kBadMacDecayTicks;
    if (state_.bad_macs == kMaxBadMacs) {
      state_.bad_macs = 0;
      state_.locked_ticks = kLockoutTicks;
    }
    return GateResult::kBadMac;
  }
  state_.counter = counter;
  memcpy(state_.last, data, kCommandSize);
  return GateResult::kAccepted;
}

void CommandGate::tick() {
  if (state_.locked_ticks != 0) --state_.locked_ticks;
  if (state_.bad_macs == 0) return;
  if (--state_.bad_mac_decay_ticks == 0) {
    --state_.bad_macs;
    state_.bad_mac_decay_ticks = kBadMacDecayTicks;
  }
}

}  // namespace screed
