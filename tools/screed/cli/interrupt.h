// Ctrl-C and a polite kill, for subcommands that end what they do in order.
#pragma once

#include <atomic>

namespace screed {

/// From now on SIGINT and SIGTERM set the flag instead of ending the program.
void catch_interrupts();

/// As if a signal had come.
void interrupt();

/// Set once a signal came.
const std::atomic<bool>& interrupted();

}  // namespace screed
