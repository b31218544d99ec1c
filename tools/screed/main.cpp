// `screed`, the one host program.
#include "tools/command_line/program.h"
#include "tools/screed/cli/command_line.h"
#include "tools/screed/cli/interrupt.h"
#include "version.h"

int main(int argc, char** argv) {
  screed::CommandLine line(SCREED_VERSION, SCREED_VERSION_TEXT);
  return screed::run_program(line.app, argc, argv,
                             [&] { return screed::run_interruptible(line.program.action); });
}
