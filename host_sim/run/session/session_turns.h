// Reading a session while its run goes on. What stands on the disk between two of HDF5's writes is
// no session. So the writer takes a turn for each block, at whose end the file is whole, and a
// reader takes one to copy it. HDF5's own locks would let neither begin while the other is there.
#pragma once

#include <filesystem>
#include <vector>

namespace screed {

/// Whether a SessionTurns that writes is there for the file.
bool is_being_written(const std::filesystem::path& file);

/// Turns at a file between programs. For std::lock_guard. Where the file system has no locks turns
/// come at once.
class SessionTurns {
 public:
  /// The file exists. Throws RunError when it cannot be opened.
  SessionTurns(const std::filesystem::path& file, bool writes);
  SessionTurns(const SessionTurns&) = delete;
  SessionTurns& operator=(const SessionTurns&) = delete;
  ~SessionTurns();

  void lock();
  void unlock();

  /// All bytes of the file. Needs a turn.
  [[nodiscard]] std::vector<char> bytes() const;

 private:
  std::filesystem::path path_;
  bool writes_;
  int file_;
};

}  // namespace screed
