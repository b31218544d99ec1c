// A log of CAN frames as messages.
#include "host_sim/ground_station/telemetry/log_decoder.h"

#include <bit>
#include <cstring>
#include <utility>

#include "host_sim/core/errors.h"

namespace screed {

static_assert(std::endian::native == std::endian::little, "bits are taken as they stand in memory");

std::string DecodeStatistics::text() const {
  std::string text = std::to_string(messages) + " messages of " + std::to_string(lines) + " lines";
  const auto add = [&](uint64_t count, const std::string& what) {
    if (count > 0) text += ", " + std::to_string(count) + " " + what;
  };
  add(unreadable_lines,
      "unreadable (the first is line " + std::to_string(first_unreadable_line) + ")");
  add(wrong_sizes, "of a wrong size");
  add(wrong_crcs, "with a wrong CRC");
  add(unknown_ids, "with ids of others");
  add(other_frames, "remote, error, FD or 29-bit frames");
  add(missing, "messages missing by their counters");
  return text;
}

LogDecoder::LogDecoder(CandumpReader reader) : reader_(std::move(reader)) {
  counters_.fill(-1);
}

void LogDecoder::watch_counter(const CanFrame& frame) {
  const int counter = frame.data[1] & 0x0F;
  int8_t& last = counters_[frame.id];
  if (last >= 0 && counter != last) {
    statistics_.missing += static_cast<uint64_t>((counter - last - 1) & 0x0F);
  }
  last = static_cast<int8_t>(counter);
}

bool LogDecoder::next(DecodedFrame& decoded) {
  LineKind kind{};
  LoggedFrame logged;
  while (reader_.next(kind, logged)) {
    ++statistics_.lines;
    if (kind != LineKind::kFrame) {
      if (kind == LineKind::kOtherFrame) {
        ++statistics_.other_frames;
      } else if (++statistics_.unreadable_lines == 1) {
        statistics_.first_unreadable_line = reader_.line_number();
      }
      continue;
    }
    switch (check_frame(logged.frame)) {
      case FrameFault::kUnknownId:
        ++statistics_.unknown_ids;
        continue;
      case FrameFault::kWrongSize:
        ++statistics_.wrong_sizes;
        continue;
      case FrameFault::kWrongCrc:
        ++statistics_.wrong_crcs;
        continue;
      case FrameFault::kWrongWay:  // a log holds both ways
      case FrameFault::kNone:
        break;
    }
    ++statistics_.messages;
    decoded.time_us = logged.time_us;
    decoded.message = find_message(logged.frame.id);
    decoded.node = node_of(logged.frame.id);
    std::memcpy(&decoded.bits, logged.frame.data, sizeof decoded.bits);
    if (decoded.message->protected_by_crc) watch_counter(logged.frame);
    return true;
  }
  return false;
}

void LogDecoder::expect_messages() const {
  if (statistics_.messages > 0) return;
  const std::string& path = reader_.path();
  if (statistics_.lines == 0) throw InputError(path + ": is empty; expected a log of candump -L");
  const bool no_log = statistics_.unreadable_lines == statistics_.lines;
  throw InputError(path +
                   (no_log ? ": is no candump log: " : ": holds no message that can be read: ") +
                   statistics_.text());
}

}  // namespace screed
