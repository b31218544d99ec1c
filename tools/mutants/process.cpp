#include "tools/mutants/process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thread>

namespace screed::mutants {
namespace {

constexpr rlim_t kMaxMemory = rlim_t{6} << 30;
constexpr rlim_t kLargestFile = rlim_t{1} << 30;
constexpr std::streamoff kKeptBytes = 200'000;
constexpr double kSomeTime_s = 0.05;

void limit(int resource, rlim_t value) {
  const rlimit both{value, value};
  setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

/// In the child. The interval timer passes to the program; for its own children there is the limit
/// in whole seconds.
[[noreturn]] void become(std::vector<char*> arguments,
                         const std::map<std::string, std::string>& environment, double limit_s,
                         const std::filesystem::path& output) {
  setpgid(0, 0);
  for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
  const int out = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int in = open("/dev/null", O_RDONLY);
  dup2(in, STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(out, STDERR_FILENO);
  if (limit_s > 0.0) {
    limit(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(limit_s)) + 1);
    limit(RLIMIT_DATA, kMaxMemory);
    limit(RLIMIT_FSIZE, kLargestFile);
    itimerval timer{};
    timer.it_value.tv_sec = static_cast<time_t>(limit_s);
    timer.it_value.tv_usec = static_cast<suseconds_t>(1e6 * (limit_s - std::floor(limit_s))) + 1;
    setitimer(ITIMER_PROF, &timer, nullptr);
  }
  limit(RLIMIT_CORE, 0);
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  _exit(127);
}

double processor_time_s(pid_t process) {
  clockid_t clock = 0;
  timespec time{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0.0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::string end_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  in.seekg(size > kKeptBytes ? size - kKeptBytes : 0);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

Ended run(const std::vector<std::string>& command,
          const std::map<std::string, std::string>& environment, double limit_s,
          const std::filesystem::path& output) {
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  const pid_t child = fork();
  if (child == 0) become(arguments, environment, limit_s, output);
  int status = 0;
  bool hung = false;
  if (limit_s <= 0.0) {
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
  } else {
    // What sleeps for ever uses no processor time; what waits for a processor gets some.
    const std::chrono::duration<double> patience(30.0 + 20.0 * limit_s);
    auto latest = std::chrono::steady_clock::now() + patience;
    double used_s = 0.0;
    auto pause = std::chrono::microseconds(500);
    while (waitpid(child, &status, WNOHANG) == 0) {
      if (const double now_s = processor_time_s(child); now_s > used_s + kSomeTime_s) {
        used_s = now_s;
        latest = std::chrono::steady_clock::now() + patience;
      }
      if (std::chrono::steady_clock::now() > latest) {
        hung = true;
        kill(-child, SIGKILL);
        waitpid(child, &status, 0);
        break;
      }
      std::this_thread::sleep_for(pause);
      if (pause < std::chrono::milliseconds(10)) pause *= 2;
    }
  }
  kill(-child, SIGKILL);
  const bool limited =
      WIFSIGNALED(status) && (WTERMSIG(status) == SIGPROF || WTERMSIG(status) == SIGXCPU ||
                              (WTERMSIG(status) == SIGKILL && limit_s > 0.0));
  return {WIFEXITED(status) && WEXITSTATUS(status) == 0, hung || limited, end_of(output)};
}

}  // namespace screed::mutants
