// The frames that travel between robot and ground. Their ids, sizes and fields are made from
// screed.dbc, which is the one place to change them; here is what a DBC file cannot say.
//
// id = class[10:8] | node[7:4] | index[3:0] (node.h); here stand those of node 1. A protected frame
// starts with the two bytes of e2e.h; bits 12..15 carry four bits of the message. All numbers are
// little endian.
#pragma once

#include <stdint.h>

#include "firmware/protocol/bytes.h"
#include "firmware/protocol/node.h"
#include "firmware/protocol/slcan.h"
#include "schema/messages.h"

namespace screed {

using CommandOp = message::CommandOp;

constexpr uint8_t kE2eHeaderSize = 2;

/// Size and data of a message; its protection is written afterwards, and what is behind it is left.
template <typename Message>
void set(CanFrame& frame, const Message& message) {
  frame.size = Message::kSize;
  message.pack(frame.data);
}

/// The frame of a message, its protection still missing.
template <typename Message>
CanFrame frame_of(const Message& message) {
  CanFrame frame{};
  frame.id = Message::kId;
  set(frame, message);
  return frame;
}

/// The argument of CommandOp::kDrive. speed: +-2047 mm/s; turn: +-204.7 degrees/s in tenths.
struct DriveArgument {
  int16_t speed_mm_per_s;
  int16_t turn_ddeg_per_s;
};
void put_drive_argument(uint8_t* at, const DriveArgument& argument);
DriveArgument get_drive_argument(const uint8_t* at);

}  // namespace screed
