// Ctrl-C, a polite kill and a terminal that went away.
#include "tools/screed/cli/interrupt.h"

#include <csignal>

namespace screed {
namespace {

std::atomic<bool> flag = false;
std::atomic<int> signal_come = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "set in a signal handler");

extern "C" void on_signal(int number) {
  signal_come.store(number);
  flag.store(true);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGHUP, on_signal);
}

void interrupt() {
  flag.store(true);
}

const std::atomic<bool>& interrupted() {
  return flag;
}

int interrupted_exit_code() {
  const int number = signal_come.load();
  return number == 0 ? 0 : 128 + number;
}

}  // namespace screed
