// fork, exec and a pipe. Not posix_spawn: it has no attribute for a child that dies with its
// parent.
#include "host_sim/render/scene/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

/// In the child, with async-signal-safe functions only; returns when it fails.
void become(char* const* words, const char* folder, pid_t parent, int messages) {
  setpgid(0, 0);
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent) return;
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(nothing, STDOUT_FILENO) < 0) return;
  if (dup2(messages, STDERR_FILENO) < 0 || chdir(folder) != 0) return;
  execvp(words[0], words);
}

}  // namespace

ChildProcess::ChildProcess(std::vector<std::string> words, const std::filesystem::path& folder) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const auto refuse = [&](int error) {
    throw RunError(words.front() + ": " + std::strerror(error));
  };
  std::array<int, 2> messages{};
  std::array<int, 2> failure{};  // closed by a successful exec, else the child writes errno
  if (pipe2(messages.data(), O_CLOEXEC) != 0) refuse(errno);
  messages_ = messages[0];
  const pid_t parent = getpid();
  if (pipe2(failure.data(), O_CLOEXEC) != 0 || (child_ = fork()) < 0) {
    const int error = errno;
    for (const int end : messages) close(end);
    refuse(error);
  }
  if (child_ == 0) {
    become(arguments.data(), folder.c_str(), parent, messages[1]);
    const int error = errno;
    static_cast<void>(!write(failure[1], &error, sizeof error));
    _exit(127);
  }
  close(messages[1]);
  close(failure[1]);
  int error = 0;
  ssize_t got = 0;
  do {
    got = read(failure[0], &error, sizeof error);
  } while (got < 0 && errno == EINTR);
  close(failure[0]);
  if (got <= 0) return;
  while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
  child_ = 0;
  close(messages_);
  messages_ = -1;
  if (error != ENOENT) refuse(error);
}

ChildProcess::~ChildProcess() {
  if (messages_ >= 0) close(messages_);
  if (!found()) return;
  kill(-child_, SIGKILL);
  while (!status_.has_value() && waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::string ChildProcess::messages(int wait_ms) {
  std::array<char, 4096> block{};
  std::string text;
  for (int wait = wait_ms;; wait = 0) {
    pollfd ready{messages_, POLLIN, 0};
    if (poll(&ready, 1, wait) <= 0) return text;
    const ssize_t got = read(messages_, block.data(), block.size());
    if (got > 0) {
      text.append(block.data(), static_cast<std::size_t>(got));
    } else if (got == 0 || errno != EINTR) {
      close(messages_);
      messages_ = -1;
      return text;
    }
  }
}

std::optional<int> ChildProcess::ended() {
  int status = 0;
  if (!status_.has_value() && waitpid(child_, &status, WNOHANG) == child_) {
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  return status_;
}

}  // namespace screed
