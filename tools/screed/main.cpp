// `screed`, the one host program.
#include <iostream>
#include <new>

#include "host_sim/core/errors.h"
#include "host_sim/core/lanes/instruction_set.h"
#include "tools/command_line/program.h"
#include "tools/screed/cli/command_line.h"
#include "tools/screed/cli/interrupt.h"
#include "version.h"

int main(int argc, char** argv) {
  try {
    screed::instruction_sets();  // the defaults of options ask for them
    screed::CommandLine line(SCREED_VERSION, SCREED_VERSION_TEXT);
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
