// `screed`, the one host program.
#include "commands.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/program.h"
#include "version.h"

int main(int argc, char** argv) {
  CLI::App app("Screed: firmware for a terrain-leveling robot, and its simulation twin", "screed");
  app.set_version_flag("--version", SCREED_VERSION);
  app.require_subcommand(1);
  screed::Program program{SCREED_VERSION, {}};
  screed::register_screed_subcommands(app, program);
  return screed::run_program(app, argc, argv,
                             [&] { return screed::run_interruptible(program.action); });
}
