// Ctrl-C, a polite kill and a terminal that went away, for subcommands that end what they do in
// order.
#pragma once

#include <atomic>

namespace screed {

/// From now on SIGINT, SIGTERM and SIGHUP set the flag instead of ending the program.
void catch_interrupts();

/// As if a signal had come: the user closed the window.
void interrupt();

/// Set once a signal came.
const std::atomic<bool>& interrupted();

/// What a program ends with whose work a signal cut short: 128 + the signal's number, as a shell
/// has it. 0 when no signal came.
int interrupted_exit_code();

}  // namespace screed
