// Ctrl-C, a polite kill and a terminal that went away.
#include "tools/screed/cli/interrupt.h"

#include <csignal>
#include <iostream>

#include "host_sim/core/task_progress.h"

namespace screed {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};

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
  for (const int signal : kSignals) std::signal(signal, on_signal);
}

CatchInterrupts::CatchInterrupts() : before_{} {
  for (std::size_t i = 0; i < kSignals.size(); ++i)
    before_.at(i) = std::signal(kSignals.at(i), on_signal);
}

CatchInterrupts::~CatchInterrupts() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) std::signal(kSignals.at(i), before_.at(i));
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

void stop_if_interrupted(std::string_view task) {
  if (interrupted()) throw TaskStopped(task);
}

int run_interruptible(const std::function<int()>& action) {
  try {
    return action();
  } catch (const TaskStopped& stopped) {
    std::cerr << "screed: stopped while " << stopped.what() << "\n";
    return interrupted_exit_code();
  }
}

}  // namespace screed
