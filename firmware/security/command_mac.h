// The message authentication code of a command: SecOC profile 1 (8 bits of freshness and 24 bits of
// MAC travel), over more than travels.
//
//   byte 0   u16  CAN id
//   byte 2   u8   robot id
//   byte 3   u32  freshness: boot epoch << 16 | counter
//   byte 7   4    op and argument, the first four bytes of the frame
//
// The MAC is the first three bytes of SipHash-2-4 over these 11 bytes. Robot and ground station use
// this same code.
#pragma once

#include <stdint.h>

#include "firmware/security/siphash.h"

namespace screed {

constexpr uint8_t kCommandSize = 8;             ///< bytes of a COMMAND frame
constexpr uint8_t kCommandBodySize = 4;         ///< op and argument
constexpr uint8_t kCommandFreshnessOffset = 4;  ///< lower 8 bits of the counter
constexpr uint8_t kCommandMacOffset = 5;
constexpr uint8_t kCommandMacSize = 3;

/// data: at least the first four bytes of the frame. mac: the first kCommandMacSize bytes count.
void command_mac(const uint8_t* key, uint16_t can_id, uint8_t robot_id, uint16_t boot_epoch,
                 uint16_t counter, const uint8_t* data, uint8_t (&mac)[kSipHashSize]);

}  // namespace screed
