// Processes, pipes.
#include "host_sim/engine/worker_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr int kCannotExecute = 127;

struct Pipe {
  int read_end = -1;
  int write_end = -1;
};

Pipe make_pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw RunError(std::string("cannot start a worker: ") + std::strerror(errno));
  return {ends[0], ends[1]};
}

void close_end(int& descriptor) {
  if (descriptor >= 0) static_cast<void>(close(std::exchange(descriptor, -1)));
}

/// Between fork and exec: nothing here allocates memory.
[[noreturn]] void become_worker(char* const* arguments, const char* log, int input, int output,
                                pid_t parent) {
  static_cast<void>(setpgid(0, 0));
  static_cast<void>(prctl(PR_SET_PDEATHSIG, SIGKILL));
  if (getppid() != parent) _exit(kCannotExecute);  // it ended before that was set
  const int errors = open(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (errors >= 0) static_cast<void>(dup2(errors, STDERR_FILENO));
  static_cast<void>(dup2(input, STDIN_FILENO));
  static_cast<void>(dup2(output, STDOUT_FILENO));
  execv("/proc/self/exe", arguments);
  _exit(kCannotExecute);
}

}  // namespace

WorkerProcess::WorkerProcess(const std::vector<std::string>& arguments,
                             const std::filesystem::path& log) {
  signal(SIGPIPE, SIG_IGN);  // a worker that is gone shows when its answer is read
  std::vector<std::string> words = {std::filesystem::read_symlink("/proc/self/exe").string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  Pipe to_worker = make_pipe();
  Pipe from_worker = make_pipe();
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) {
    become_worker(pointers.data(), log.c_str(), to_worker.read_end, from_worker.write_end, parent);
  }
  const int reason = errno;
  close_end(to_worker.read_end);
  close_end(from_worker.write_end);
  input_ = to_worker.write_end;
  output_ = from_worker.read_end;
  if (pid_ < 0) {
    close_pipes();
    throw RunError(std::string("cannot start a worker: ") + std::strerror(reason));
  }
}

WorkerProcess::~WorkerProcess() {
  kill();
  wait();
  close_pipes();
}

void WorkerProcess::close_pipes() {
  close_end(input_);
  close_end(output_);
}

void WorkerProcess::send(const std::string& line) const {
  const std::string text = line + "\n";
  static_cast<void>(write(input_, text.data(), text.size()));
}

bool WorkerProcess::receive(std::vector<std::string>& lines) {
  while (true) {
    pollfd ready{output_, POLLIN, 0};
    if (poll(&ready, 1, 0) <= 0) return true;
    std::array<char, 4096> buffer{};
    const ssize_t count = read(output_, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    received_.append(buffer.data(), static_cast<size_t>(count));
    for (size_t end = received_.find('\n'); end != std::string::npos; end = received_.find('\n')) {
      lines.push_back(received_.substr(0, end));
      received_.erase(0, end + 1);
    }
  }
}

void WorkerProcess::finish() {
  close_end(input_);
}

void WorkerProcess::kill() {
  if (pid_ > 0) static_cast<void>(::kill(pid_, SIGKILL));
}

std::string WorkerProcess::wait() {
  if (pid_ <= 0) return "";
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) continue;
  pid_ = -1;
  if (WIFSIGNALED(status)) {
    const int number = WTERMSIG(status);
    return "ended by signal " + std::to_string(number) + " (" + strsignal(number) + ")";
  }
  return "ended with exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace screed
