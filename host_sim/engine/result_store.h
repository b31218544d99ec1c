// Results of tasks on disk: files that are only ever appended to, a line for each task
// (a run of a campaign, say).
//
// A line is
//
//   CHECK ID STATUS RESULT-HASH {"result": {...}, "provenance": {...}}\n
//
// CHECK is the hash of everything behind it, so that a line that a full disk, a power cut or a bad
// block left half is recognized; its task counts as not done. Each writer has a file of its own, so
// that any number of processes on any number of machines may write at a time, and a killed one
// leaves at worst half a line at the end of its file. Knows nothing of what a task is.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace screed {

enum class ResultStatus : uint8_t { kDone, kFailed };

struct StoredResult {
  std::string id;  ///< of the task, without blanks
  ResultStatus status = ResultStatus::kDone;
  std::string result;      ///< JSON: what the task yields; the same for the same task
  std::string provenance;  ///< JSON: where, when, how long
};

/// Appends results to a new file. Throws RunError, one line with the path and the reason, when it
/// cannot be made or written; what was appended before stays.
class ResultWriter {
 public:
  /// Makes `folder`/NAME.jsonl, the folder too; NAME names machine, process and time.
  explicit ResultWriter(const std::filesystem::path& folder);
  ResultWriter(const ResultWriter&) = delete;
  ResultWriter& operator=(const ResultWriter&) = delete;
  /// A file without any result disappears.
  ~ResultWriter();

  const std::filesystem::path& path() const { return path_; }
  /// In one write. It reaches the disk at once when the last one did half a second ago or more.
  void append(const StoredResult& result);

 private:
  using Clock = std::chrono::steady_clock;

  std::filesystem::path path_;
  int descriptor_ = -1;
  int64_t size_ = 0;
  Clock::time_point synced_;
};

/// Where the line of a result stands.
struct ResultPlace {
  size_t file = 0;
  uint64_t offset = 0;
  size_t length = 0;  ///< without the line's end
  size_t line = 0;    ///< 1-based
  ResultStatus status = ResultStatus::kDone;
  std::string hash;  ///< of the result
};

/// What the files of a folder hold, for each run the line that counts: one that is done before one
/// that failed, then the first by file name and line.
class ResultIndex {
 public:
  /// An empty index when there is no such folder. Throws InputError when a run has two different
  /// results, RunError when a file cannot be read.
  explicit ResultIndex(const std::filesystem::path& folder);

  bool done(const std::string& id) const;
  bool failed(const std::string& id) const;
  /// Lines that say that this run failed.
  size_t failures(const std::string& id) const;
  /// Reads the line that counts; there must be one. One thread at a time. Throws RunError.
  StoredResult read(const std::string& id) const;
  /// Of all runs in the files, whatever campaign they belong to.
  const std::map<std::string, ResultPlace>& places() const { return places_; }
  /// Whole lines that are damaged, one message each, with file and line.
  const std::vector<std::string>& damaged() const { return damaged_; }
  /// What is odd about the files, one note each: damaged lines, and how many results are of runs
  /// that `is_known` does not know.
  std::vector<std::string> oddities(const std::function<bool(const std::string&)>& is_known) const;

 private:
  void read_file(size_t file);
  void take(const std::string& id, const ResultPlace& place);
  std::string name(const ResultPlace& place) const;

  std::vector<std::filesystem::path> files_;
  std::map<std::string, ResultPlace> places_;
  std::map<std::string, size_t> failures_;
  std::vector<std::string> damaged_;
  mutable std::ifstream stream_;  ///< of the file that was read from last
  mutable size_t open_ = 0;
};

}  // namespace screed
