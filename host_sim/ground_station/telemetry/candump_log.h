// Files of CAN frames, a line of candump_line.h each.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/ground_station/telemetry/candump_line.h"
#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {

/// Appends to a log, frame by frame: whatever ends the program, the log has what it heard.
class CandumpWriter {
 public:
  /// link: the port or interface that frames come from, in the log by its last name: "ttyUSB0".
  /// A last line that was cut, by a power failure say, stays what it is: a new one begins.
  /// Throws InputError when the file cannot be written.
  CandumpWriter(const std::string& path, const std::string& link);

  void add(uint64_t time_us, const CanFrame& frame);
  /// Throws RunError when not all could be written.
  void check() const;

 private:
  std::string path_;
  std::string interface_;
  std::ofstream file_;
};

/// Reads a log of any size and content, line by line.
class CandumpReader {
 public:
  static constexpr size_t kBufferBytes = 1U << 20U;

  /// "-" reads standard input. Throws InputError when the file cannot be opened.
  explicit CandumpReader(const std::string& path);
  /// Reads an open file, which it closes. path: what messages call it. buffer_bytes: a longer line
  /// is unreadable.
  CandumpReader(std::string path, std::FILE* file, size_t buffer_bytes = kBufferBytes);

  /// The next line that is not empty; false at the end. Throws InputError when reading fails.
  bool next(LineKind& kind, LoggedFrame& frame);

  /// What messages call it.
  [[nodiscard]] const std::string& path() const { return path_; }

  /// Number of the line that next() read, from 1.
  [[nodiscard]] uint64_t line_number() const { return line_number_; }

 private:
  struct Closer {
    void operator()(std::FILE* file) const;
  };
  bool fill();

  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::vector<char> buffer_;
  size_t begin_ = 0;       ///< of the bytes that wait in the buffer
  size_t end_ = 0;         ///< behind them
  size_t searched_ = 0;    ///< no end of line stands before this place
  bool too_long_ = false;  ///< the line under way did not fit into the buffer
  uint64_t line_number_ = 0;
};

// A log of CAN frames as messages: what can be read, and counts of what cannot.

/// Time since the first message of a log, whose clock may be set while it is written (by NTP, by a
/// start without a battery-backed clock): no time passes where it steps.
class LogClock {
 public:
  /// A step back by less is two interfaces' frames out of order; the latest time stands.
  static constexpr uint64_t kMinStepBack_us = 1'000'000;
  /// Robots are never silent for longer: a clock that was set ahead, or a recording that paused.
  static constexpr uint64_t kLongestSilence_us = 60'000'000;

  /// The next time that the log says, and the number of its line. Returns what passed since the one
  /// before it.
  uint64_t add(uint64_t time_us, uint64_t line);

  [[nodiscard]] uint64_t elapsed_us() const { return elapsed_us_; }
  /// One line for people about its steps; empty without any.
  [[nodiscard]] std::string text() const;

 private:
  std::optional<uint64_t> latest_us_;
  uint64_t elapsed_us_ = 0;
  uint64_t steps_ = 0;
  uint64_t first_line_ = 0;
  double first_step_s_ = 0.0;
};

/// One message of a log.
struct DecodedFrame {
  uint64_t time_us = 0;     ///< as the log says
  uint64_t elapsed_us = 0;  ///< as LogClock says
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
  uint64_t untimed = 0;                ///< frames without a time
  uint64_t other_frames = 0;           ///< remote, error, FD, 29-bit ids
  uint64_t unknown_ids = 0;
  uint64_t wrong_sizes = 0;
  uint64_t wrong_crcs = 0;
  uint64_t missing = 0;  ///< messages that the alive counters say were sent and are not in the log

  LogClock clock;

  /// Lines and frames that should be messages and are not.
  [[nodiscard]] uint64_t damaged() const {
    return unreadable_lines + untimed + wrong_sizes + wrong_crcs;
  }
  /// Whether text() says more than how many messages there are.
  [[nodiscard]] bool is_odd() const { return damaged() > 0 || !clock.text().empty(); }
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
