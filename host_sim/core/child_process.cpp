// fork, exec and pipes. Not posix_spawn: it has no attribute for a child that dies with its
// parent.
#include "host_sim/core/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <utility>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

void close_end(int& descriptor) {
  if (descriptor >= 0) static_cast<void>(close(std::exchange(descriptor, -1)));
}

/// Both ends are closed at the end; of what the parent keeps it takes the descriptor.
struct Pipe {
  Pipe() = default;
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_end(ends[0]);
    close_end(ends[1]);
  }
  bool open() { return pipe2(ends.data(), O_CLOEXEC) == 0; }

  std::array<int, 2> ends{-1, -1};  ///< to read from, to write to
};

/// In the child, with async-signal-safe functions only; returns when it fails.
void become(const ChildStart& start, char* const* words, pid_t parent, int input, int output) {
  setpgid(0, 0);
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent) return;
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  const int log = start.log.empty()
                      ? -1
                      : open(start.log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  const int rest = log >= 0 ? log : nothing;
  if (nothing < 0) return;
  if (dup2(start.is_sent_lines ? input : nothing, STDIN_FILENO) < 0 ||
      dup2(start.output_is_read ? output : rest, STDOUT_FILENO) < 0 ||
      dup2(start.errors_are_read ? output : rest, STDERR_FILENO) < 0)
    return;
  if (!start.folder.empty() && chdir(start.folder.c_str()) != 0) return;
  if (start.program.empty()) {
    execvp(words[0], words);
  } else {
    execv(start.program.c_str(), words);
  }
}

}  // namespace

ChildProcess::ChildProcess(ChildStart start) {
  std::vector<char*> words;
  words.reserve(start.words.size() + 1);
  for (std::string& word : start.words) words.push_back(word.data());
  words.push_back(nullptr);
  const auto refuse = [&](int error) {
    throw RunError(start.words.front() + ": " + std::strerror(error));
  };
  Pipe to_child;
  Pipe from_child;
  Pipe failure;  // closed by a successful exec, else the child writes errno
  if (!to_child.open() || !from_child.open() || !failure.open()) refuse(errno);
  const pid_t parent = getpid();
  child_ = fork();
  if (child_ < 0) refuse(errno);
  if (child_ == 0) {
    become(start, words.data(), parent, to_child.ends[0], from_child.ends[1]);
    const int error = errno;
    static_cast<void>(!write(failure.ends[1], &error, sizeof error));
    _exit(127);
  }
  close_end(failure.ends[1]);
  int error = 0;
  ssize_t got = 0;
  do {
    got = read(failure.ends[0], &error, sizeof error);
  } while (got < 0 && errno == EINTR);
  if (got <= 0) {
    if (start.is_sent_lines) {
      signal(SIGPIPE, SIG_IGN);  // a child that is gone shows when it is read from
      input_ = std::exchange(to_child.ends[1], -1);
    }
    if (start.output_is_read || start.errors_are_read)
      output_ = std::exchange(from_child.ends[0], -1);
    return;
  }
  take_end(0);
  child_ = 0;
  if (error != ENOENT) refuse(error);
}

ChildProcess::~ChildProcess() {
  close_end(input_);
  close_end(output_);
  if (!found()) return;
  kill(-child_, SIGKILL);
  wait();
}

void ChildProcess::send(const std::string& line) const {
  const std::string text = line + "\n";
  static_cast<void>(!write(input_, text.data(), text.size()));
}

void ChildProcess::finish() {
  close_end(input_);
}

bool ChildProcess::receive(std::string& text, int wait_ms) {
  std::array<char, 4096> block{};
  for (int wait = wait_ms;; wait = 0) {
    pollfd ready{output_, POLLIN, 0};
    if (poll(&ready, 1, wait) <= 0) return output_ >= 0;
    const ssize_t got = read(output_, block.data(), block.size());
    if (got > 0) {
      text.append(block.data(), static_cast<std::size_t>(got));
    } else if (got == 0 || errno != EINTR) {
      close_end(output_);
      return false;
    }
  }
}

std::optional<int> ChildProcess::take_end(int flags) {
  int status = 0;
  pid_t ended = 0;
  while (!status_.has_value() && (ended = waitpid(child_, &status, flags)) < 0 && errno == EINTR) {
  }
  if (ended == child_) status_ = status;
  if (!status_.has_value()) return std::nullopt;
  return WIFEXITED(*status_) ? WEXITSTATUS(*status_) : -1;
}

std::optional<int> ChildProcess::ended() {
  return take_end(WNOHANG);
}

int ChildProcess::wait() {
  return take_end(0).value_or(-1);
}

std::string ChildProcess::end_text() const {
  const int status = status_.value_or(0);
  if (WIFSIGNALED(status)) {
    const int number = WTERMSIG(status);
    return "ended by signal " + std::to_string(number) + " (" + strsignal(number) + ")";
  }
  return "ended with exit code " + std::to_string(WEXITSTATUS(status));
}

ShellOutput shell_output(const std::string& command) {
  ShellOutput output;
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> block{};
  for (std::size_t count = 0; (count = std::fread(block.data(), 1, block.size(), pipe)) > 0;)
    output.text.append(block.data(), count);
  const int status = pclose(pipe);
  output.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return output;
}

}  // namespace screed
