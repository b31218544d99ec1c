// Ctrl-C and a polite kill.
#include "tools/screed/cli/interrupt.h"

#include <csignal>

namespace screed {
namespace {

std::atomic<bool> flag = false;
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

extern "C" void on_signal(int) {
  flag.store(true);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

void interrupt() {
  flag.store(true);
}

const std::atomic<bool>& interrupted() {
  return flag;
}

}  // namespace screed
