#include "tools/flash/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "host_sim/core/errors.h"

namespace screed::flash {
namespace {

pid_t start(const std::vector<std::string>& command, int output) {
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (const auto& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, output, STDERR_FILENO);
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error == ENOENT)
    throw RunError(command[0] + " is not installed: make deps, or apt install " + command[0]);
  if (error != 0) throw RunError("cannot run " + command[0] + ": " + std::strerror(error));
  return child;
}

}  // namespace

ChildOutcome run_child(const std::vector<std::string>& command,
                       std::chrono::milliseconds idle_timeout,
                       const std::function<bool(std::string_view)>& listen) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw RunError(std::string("cannot open a pipe: ") + std::strerror(errno));
  pid_t child = 0;
  try {
    child = start(command, ends[1]);
  } catch (...) {
    close(ends[0]);
    close(ends[1]);
    throw;
  }
  close(ends[1]);

  ChildOutcome outcome;
  while (true) {
    pollfd wait{ends[0], POLLIN, 0};
    const int ready = poll(&wait, 1, static_cast<int>(idle_timeout.count()));
    if (ready < 0 && errno == EINTR) continue;
    bool go_on = ready > 0;
    if (go_on) {
      char piece[4096];
      const ssize_t size = read(ends[0], piece, sizeof piece);
      if (size <= 0) break;
      outcome.said.append(piece, static_cast<std::size_t>(size));
      go_on = listen(outcome.said);
    }
    if (!go_on) {
      outcome.killed = true;
      kill(child, SIGKILL);
      break;
    }
  }
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

}  // namespace screed::flash
