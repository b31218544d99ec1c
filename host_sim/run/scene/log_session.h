// A robot's own telemetry log as the sessions of a run, so that what shows a run shows a drive.
//
// A row every 50 ms, with what the robot said of itself: place, heading and attitude as it
// estimates them, between two messages on a straight line; speeds and slip of its tracks; battery,
// states and faults. What telemetry does not carry is not a number. The ground is flat, since a
// robot knows no heights. Such a session cannot be replayed: there are no samples in it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace screed {

/// What a user names to have it shown: a run folder or session file, which is left alone, or a log
/// in the format of candump -L, of which sessions are made in a temporary folder, as long as this
/// object lives.
class ShownRun {
 public:
  /// board: of the robots of a log. Throws InputError.
  ShownRun(const std::filesystem::path& named, const std::string& board);
  ShownRun(const ShownRun&) = delete;
  ShownRun& operator=(const ShownRun&) = delete;
  ~ShownRun();

  /// Run folder or session file.
  const std::filesystem::path& path() const { return path_; }
  /// Whether it was made of a log.
  bool is_log() const { return !temporary_.empty(); }

 private:
  std::filesystem::path temporary_;
  std::filesystem::path path_;
};

/// Writes a session for each robot of the log into `folder`, which exists, as a run of several
/// robots has them (run_folder.h), the lowest node first. A silence of all robots for more than ten
/// seconds is shortened to that. Throws InputError.
void write_log_sessions(const std::filesystem::path& log, const std::filesystem::path& folder,
                        const std::string& board);

}  // namespace screed
