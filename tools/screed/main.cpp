// `screed`, the one host program.
#include <iostream>

#include "host_sim/core/errors.h"
#include "host_sim/core/lanes/instruction_set.h"
#include "tools/command_line/program.h"
#include "tools/screed/cli/command_line.h"
#include "tools/screed/cli/interrupt.h"
#include "version.h"

int main(int argc, char** argv) {
  try {
    screed::instruction_sets();  // the defaults of options ask for them
  } catch (const screed::InputError& error) {
    std::cerr << "screed: " << error.what() << "\n";
    return 2;
  }
  screed::CommandLine line(SCREED_VERSION, SCREED_VERSION_TEXT);
  return screed::run_program(line.app, argc, argv,
                             [&] { return screed::run_interruptible(line.program.action); });
}
