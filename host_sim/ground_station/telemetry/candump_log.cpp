// Logs as candump -L writes them.
#include "host_sim/ground_station/telemetry/candump_log.h"

#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"

namespace screed {

void CandumpReader::Closer::operator()(std::FILE* file) const {
  if (file != stdin) std::fclose(file);
}

CandumpWriter::CandumpWriter(const std::string& path, const std::string& link)
    : path_(path),
      interface_(std::filesystem::path(link).filename()),
      file_(path, std::ios::app | std::ios::binary) {
  if (!file_) throw InputError(path + ": cannot be written");
  std::ifstream before(path, std::ios::ate | std::ios::binary);
  if (before.tellg() > 0 && before.seekg(-1, std::ios::end).get() != '\n') file_ << '\n';
}

void CandumpWriter::add(uint64_t time_us, const CanFrame& frame) {
  file_ << candump_line(time_us, interface_, frame) << std::flush;
}

void CandumpWriter::check() const {
  if (!file_) throw RunError(path_ + ": cannot be written completely; is the disk full?");
}

CandumpReader::CandumpReader(const std::string& path)
    : CandumpReader(path, path == "-" ? stdin : std::fopen(path.c_str(), "rb")) {}

CandumpReader::CandumpReader(std::string path, std::FILE* file, size_t buffer_bytes)
    : path_(std::move(path)), file_(file), buffer_(buffer_bytes) {
  if (file_ == nullptr) throw InputError(path_ + ": cannot be read: " + std::strerror(errno));
}

bool CandumpReader::fill() {
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    searched_ -= begin_;
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) {
    // A line longer than the buffer is none of a log; its rest goes the same way.
    too_long_ = true;
    end_ = searched_ = 0;
  }
  const size_t got = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
  if (got == 0 && std::ferror(file_.get()) != 0) {
    throw InputError(path_ + ": cannot be read: " + std::strerror(errno));
  }
  end_ += got;
  return got > 0;
}

bool CandumpReader::next(LineKind& kind, LoggedFrame& frame) {
  for (;;) {
    const char* const from = buffer_.data() + searched_;
    const char* stop = searched_ == end_
                           ? nullptr
                           : static_cast<const char*>(std::memchr(from, '\n', end_ - searched_));
    bool last = false;
    if (stop == nullptr) {
      searched_ = end_;
      if (fill()) continue;
      if (begin_ == end_ && !too_long_) return false;
      stop = buffer_.data() + end_;  // a last line without its end
      last = true;
    }
    const std::string_view line(buffer_.data() + begin_,
                                static_cast<size_t>(stop - buffer_.data()) - begin_);
    begin_ = searched_ = static_cast<size_t>(stop - buffer_.data()) + (last ? 0 : 1);
    ++line_number_;
    if (too_long_) {
      too_long_ = false;
      kind = LineKind::kUnreadable;
      return true;
    }
    if (line.empty() || line == "\r") {
      if (last) return false;
      continue;
    }
    kind = parse_candump_line(line, frame);
    return true;
  }
}

// A log of CAN frames as messages.

static_assert(std::endian::native == std::endian::little, "bits are taken as they stand in memory");

uint64_t LogClock::add(uint64_t time_us, uint64_t line) {
  const uint64_t latest_us = latest_us_.value_or(time_us);
  const bool back = time_us < latest_us;
  const uint64_t step_us = back ? latest_us - time_us : time_us - latest_us;
  if (back && step_us < kMinStepBack_us) return 0;
  latest_us_ = time_us;
  if (!back && step_us <= kLongestSilence_us) {
    elapsed_us_ += step_us;
    return step_us;
  }
  if (++steps_ == 1) {
    first_line_ = line;
    first_step_s_ = static_cast<double>(step_us) * (back ? -1e-6 : 1e-6);
  }
  return 0;
}

std::string LogClock::text() const {
  if (steps_ == 0) return "";
  const bool back = first_step_s_ < 0.0;
  std::string text = filled("the clock of the log steps {} by {:.0f} s at line {}",
                            back ? "back" : "ahead", std::abs(first_step_s_), first_line_);
  if (!back) text += ", or nothing was recorded for so long";
  if (steps_ > 1) text += " (and " + std::to_string(steps_ - 1) + " more such steps)";
  return text;
}

std::string DecodeStatistics::text() const {
  std::string text = counted(messages, "message") + " of " + counted(lines, "line");
  const auto add = [&](uint64_t count, const std::string& what) {
    if (count > 0) text += ", " + std::to_string(count) + " " + what;
  };
  add(unreadable_lines,
      "unreadable (the first is line " + std::to_string(first_unreadable_line) + ")");
  add(untimed, "without a time (candump -L writes it)");
  add(wrong_sizes, "of a wrong size");
  add(wrong_crcs, "with a wrong CRC");
  add(unknown_ids, "with ids of others");
  add(other_frames, "remote, error, FD or 29-bit frames");
  add(missing, "messages missing by their counters");
  if (const std::string steps = clock.text(); !steps.empty()) text.append("; ").append(steps);
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
      } else if (kind == LineKind::kUntimed) {
        ++statistics_.untimed;
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
    statistics_.clock.add(logged.time_us, reader_.line_number());
    decoded.elapsed_us = statistics_.clock.elapsed_us();
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
