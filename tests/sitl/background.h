// The program in the background, with its workers, to be met in the midst of its work.
#pragma once

#include <sched.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/core/child_process.h"
#include "tests/temp_folder.h"

namespace screed::testing {

/// The program in the background, in a folder; killed with this object.
class Background {
 public:
  Background(const std::string& program, std::vector<std::string> arguments,
             const std::filesystem::path& folder, const std::string& log) {
    write_text(log, "");
    arguments.insert(arguments.begin(), program);
    child_.emplace(ChildStart{.words = std::move(arguments), .folder = folder, .log = log});
  }

  void signal(int number) {
    if (runs()) kill(child_->pid(), number);
  }
  /// -1 when a signal ended it.
  int wait() { return child_->wait(); }
  bool runs() { return !child_->ended().has_value(); }
  /// Its children that have become workers.
  std::vector<pid_t> workers() const {
    std::vector<pid_t> children;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      const std::string name = entry.path().filename();
      if (name.find_first_not_of("0123456789") != std::string::npos) continue;
      // "PID (NAME) STATE PARENT ..."
      const std::string status = read_text(entry.path() / "stat");
      const size_t end = status.rfind(')');
      if (end == std::string::npos) continue;
      char state = 0;
      pid_t parent = 0;
      std::istringstream(status.substr(end + 1)) >> state >> parent;
      const bool is_worker =
          read_text(entry.path() / "cmdline").find("worker") != std::string::npos;
      if (parent == child_->pid() && state != 'Z' && is_worker) children.push_back(std::stoi(name));
    }
    return children;
  }

 private:
  std::optional<ChildProcess> child_;
};

/// Waits until it holds. False when the program has ended before.
inline bool wait_until(Background& program, const std::function<bool()>& holds) {
  while (!holds()) {
    if (!program.runs()) return false;
    sched_yield();
  }
  return true;
}

/// Waits until there is a worker, and says which there are. None when the program has ended before.
inline std::vector<pid_t> wait_for_workers(Background& program) {
  std::vector<pid_t> workers;
  wait_until(program, [&] {
    workers = program.workers();
    return !workers.empty();
  });
  return workers;
}

}  // namespace screed::testing
