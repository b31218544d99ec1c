// A log of CAN frames as messages: what can be read, and counts of what cannot.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "host_sim/ground_station/telemetry/candump_log.h"
#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {

/// One message of a log.
struct DecodedFrame {
  uint64_t time_us = 0;
  const MessageInfo* message = nullptr;
  uint8_t node = 0;   ///< the robot; 0: the ground
  uint64_t bits = 0;  ///< the data, for SignalInfo::raw()
};

/// What became of the lines of a log.
struct DecodeStatistics {
  uint64_t lines = 0;     ///< that are not empty
  uint64_t messages = 0;  ///< decoded
  uint64_t unreadable_lines = 0;
  uint64_t first_unreadable_line = 0;  ///< its number; 0: none
  uint64_t other_frames = 0;           ///< remote, error, FD, 29-bit ids
  uint64_t unknown_ids = 0;
  uint64_t wrong_sizes = 0;
  uint64_t wrong_crcs = 0;
  uint64_t missing = 0;  ///< messages that the alive counters say were sent and are not in the log

  /// Lines and frames that should be messages and are not.
  [[nodiscard]] uint64_t damaged() const { return unreadable_lines + wrong_sizes + wrong_crcs; }
  /// One line for people.
  [[nodiscard]] std::string text() const;
};

class LogDecoder {
 public:
  /// As CandumpReader.
  explicit LogDecoder(const std::string& path) : LogDecoder(CandumpReader(path)) {}
  explicit LogDecoder(CandumpReader reader);

  /// The next message; false at the end of the log. Nothing in a log makes it throw.
  bool next(DecodedFrame& frame);

  [[nodiscard]] const DecodeStatistics& statistics() const { return statistics_; }

  /// Of a log that was read to its end: throws InputError when it held no message.
  void expect_messages() const;

 private:
  void watch_counter(const CanFrame& frame);

  CandumpReader reader_;
  DecodeStatistics statistics_;
  std::array<int8_t, 2048> counters_;  ///< the last alive counter of each id; -1: none yet
};

}  // namespace screed
