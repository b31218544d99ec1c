// A program that runs beside this one and does not outlive it.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace screed {

class ChildProcess {
 public:
  /// Runs words[0], found on the path, in `folder`, in a process group of its own: Ctrl-C on the
  /// terminal does not reach it. Its input is empty, its output is dropped, its messages (standard
  /// error) are read here. Throws RunError when it cannot be run.
  ChildProcess(std::vector<std::string> words, const std::filesystem::path& folder);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  /// Kills it and what it has started, when they still run. The kernel does so to the program
  /// itself when this process is killed.
  ~ChildProcess();

  /// Whether a program of that name was found on the path.
  bool found() const { return child_ > 0; }
  /// Messages that have come since the last call, waiting at most so long for some, or for a
  /// signal.
  std::string messages(int wait_ms);
  /// Its exit status once it has ended; -1 when a signal ended it.
  std::optional<int> ended();

 private:
  pid_t child_ = 0;
  int messages_ = -1;  ///< the end of the pipe that is read
  std::optional<int> status_;
};

}  // namespace screed
