// A CAN frame as the line that `candump -L` writes and canplayer, Wireshark, SavvyCAN and
// python-can read:
//
//   (1436509052.249713) can0 210#2A366C2BBA000102
//
// Read as well: names padded with spaces (several interfaces), nanoseconds (-N), dates (-tA; they
// count as UTC), and what candump prints for people with times (-ta):
//
//   (1436509052.249713)  can0  210   [8]  2A 36 6C 2B BA 00 01 02
//
// Knows lines and frames, not what they mean. Source: can-utils, candump.c and lib.c.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "firmware/protocol/slcan.h"

namespace screed {

struct LoggedFrame {
  uint64_t time_us = 0;  ///< since 1970, or since the start of a simulation
  CanFrame frame{};
};

/// The line of a frame, its end included. interface: a name without spaces.
std::string candump_line(uint64_t time_us, std::string_view interface, const CanFrame& frame);

enum class LineKind : uint8_t {
  kFrame,       ///< a classic data frame with an 11-bit id
  kUntimed,     ///< such a frame as candump prints it without -L and -t: nobody knows when it came
  kOtherFrame,  ///< remote, error, FD, or 29-bit id: well formed, and not ours
  kUnreadable,  ///< not a line of such a log
};

/// Reads one line, without its end. `frame` is of use for a kFrame only.
LineKind parse_candump_line(std::string_view line, LoggedFrame& frame);

}  // namespace screed
