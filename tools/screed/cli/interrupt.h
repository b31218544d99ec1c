// Ctrl-C, a polite kill and a terminal that went away, for subcommands that end what they do in
// order.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <string_view>

namespace screed {

/// From now on SIGINT, SIGTERM and SIGHUP set the flag instead of ending the program.
void catch_interrupts();

/// The same while it lives; then signals do what they did before.
class CatchInterrupts {
 public:
  CatchInterrupts();
  CatchInterrupts(const CatchInterrupts&) = delete;
  CatchInterrupts& operator=(const CatchInterrupts&) = delete;
  ~CatchInterrupts();

 private:
  std::array<void (*)(int), 3> before_;
};

/// As if a signal had come: the user closed the window.
void interrupt();

/// Set once a signal came.
const std::atomic<bool>& interrupted();

/// What a program ends with whose work a signal cut short: 128 + the signal's number, as a shell
/// has it. 0 when no signal came.
int interrupted_exit_code();

/// Throws TaskStopped with the name of the task once a signal came.
void stop_if_interrupted(std::string_view task);

/// Runs the action of a subcommand and returns its exit code. Of an action that ended with
/// TaskStopped: one line on standard error, and interrupted_exit_code().
int run_interruptible(const std::function<int()>& action);

}  // namespace screed
