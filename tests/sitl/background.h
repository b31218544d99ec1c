// The program in the background, with its workers, to be met in the midst of its work.
#pragma once

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "tests/temp_folder.h"

namespace screed::testing {

/// The program in the background, in a folder; killed with this object.
class Background {
 public:
  Background(const std::string& program, std::vector<std::string> arguments,
             const std::filesystem::path& folder, const std::string& log) {
    arguments.insert(arguments.begin(), program);
    std::vector<char*> words;
    words.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    const int output = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (output < 0 || chdir(folder.c_str()) != 0 || dup2(output, STDOUT_FILENO) < 0 ||
        dup2(output, STDERR_FILENO) < 0)
      _exit(127);
    execv(words[0], words.data());
    _exit(127);
  }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  ~Background() {
    signal(SIGKILL);
    wait();
  }

  void signal(int number) const {
    if (pid_ > 0) ::kill(pid_, number);
  }
  /// -1 when a signal ended it.
  int wait() {
    if (pid_ <= 0) return exit_code_;
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return exit_code_;
  }
  bool runs() {
    int status = 0;
    if (pid_ > 0 && waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = -1;
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    return pid_ > 0;
  }
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
      if (parent == pid_ && state != 'Z' && is_worker) children.push_back(std::stoi(name));
    }
    return children;
  }

 private:
  pid_t pid_ = -1;
  int exit_code_ = -1;
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
