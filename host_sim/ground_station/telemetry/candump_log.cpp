// Logs as candump -L writes them.
#include "host_sim/ground_station/telemetry/candump_log.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include "host_sim/core/errors.h"

namespace screed {
void CandumpReader::Closer::operator()(std::FILE* file) const {
  if (file != stdin) std::fclose(file);
}

CandumpWriter::CandumpWriter(const std::string& path, const std::string& link)
    : path_(path),
      interface_(std::filesystem::path(link).filename()),
      file_(path, std::ios::app | std::ios::binary) {
  if (!file_) throw InputError(path + ": cannot be written");
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

}  // namespace screed
