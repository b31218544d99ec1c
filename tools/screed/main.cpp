// `screed`, the one host program.
#include <iostream>
#include <new>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/core/lanes/instruction_set.h"
#include "host_sim/run/session/session_layout.h"
#include "tools/command_line/program.h"
#include "tools/screed/cli/command_line.h"
#include "tools/screed/cli/interrupt.h"
#include "version.h"

/// Which program this is, what is built in, and how it computes: what a question about a run is
/// answered with.
static std::string version_text() {
  return std::string(SCREED_VERSION_TEXT "\nbuilt in: " SCREED_BUILT_IN "\narithmetic: ") +
         screed::arithmetic() + ", instructions up to " +
         screed::name_of(screed::instruction_sets().back());
}

int main(int argc, char** argv) {
  try {
    screed::CommandLine line(SCREED_VERSION, version_text());
    return screed::run_program(line.app, argc, argv,
                               [&] { return screed::run_interruptible(line.program.action); });
  } catch (const screed::InputError& error) {
    std::cerr << "screed: " << error.what() << "\n";
    return 2;
  } catch (const std::bad_alloc&) {
    std::cerr << "screed: out of memory\n";
    return 1;
  }
}
