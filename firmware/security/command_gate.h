// Decides whether a COMMAND comes from who holds the key, and is new.
//
// Freshness is 32 bits: the number of this start (EEPROM) and a counter that every accepted command
// raises. Eight bits of the counter travel; the gate takes them for the next higher number that
// ends so, and the MAC proves it right. So a command that was accepted, one of an earlier start,
// one for another robot, and one that was made up all fail alike: by their MAC.
//
// A forger who may guess 24 bits often enough is right at last. Every wrong MAC therefore is
// remembered, one is forgiven every 4 s, and at the eighth the gate stays shut for 30 s: 16 million
// guesses take years. The price: who floods the radio with wrong MACs keeps commands out; the
// emergency stop does not come this way.
#pragma once

#include <stdint.h>

#include "firmware/parameters/kept.h"
#include "firmware/security/command_mac.h"
#include "hal/sample.h"

namespace screed {

/// Refusals have the numbers they travel with in COMMAND_ACK.
enum class GateResult : uint8_t {
  kAccepted = 0,
  kNoKey = 5,
  kBadMac = 6,
  kLockedOut = 7,
  kUsedUp = 8,      ///< no counter is left in this start
  kRepeated = 255,  ///< the command that was accepted last, once more: not to be done again
};

class CommandGate {
 public:
  static constexpr uint8_t kMaxBadMacs = 8;
  static constexpr uint16_t kBadMacDecayTicks = 4 * kTickRate_hz;
  static constexpr uint16_t kLockoutTicks = 30 * kTickRate_hz;

  explicit CommandGate(const Credentials& credentials) : credentials_(credentials) {}

  /// Looks at the kCommandSize bytes of a COMMAND. Costs 10,000 cycles on the AVR: once a tick.
  GateResult check(uint16_t can_id, const uint8_t* data);

  /// One tick. Counts down lock-out and wrong MACs.
  void tick();

  /// Of the command that was accepted last; 0: none yet.
  uint16_t counter() const { return state_.counter; }
  uint16_t boot_epoch() const { return credentials_.boot_epoch; }
  /// Ticks until the gate opens; 0: it is open.
  uint16_t locked_ticks() const { return state_.locked_ticks; }
  /// Commands with a wrong MAC since start, wraps.
  uint8_t refused() const { return state_.refused; }

 private:
  /// What the gate remembers, zero at the start (one loop of the microcontroller, not a store a
  /// byte).
  struct State {
    uint16_t counter;
    uint16_t locked_ticks;
    uint16_t bad_mac_decay_ticks;
    uint8_t bad_macs;
    uint8_t refused;
    uint8_t last[kCommandSize];  ///< the command that was accepted last
  };

  State state_{};
  Kept<Credentials> credentials_;
};

}  // namespace screed
