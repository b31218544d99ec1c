// `screed soil`: the reference tests of the deformable soil, each in a file of its own.
#include "commands.h"

namespace screed {

void register_soil_command(CLI::App& root, Program& program) {
  CLI::App* command = root.add_subcommand("soil", "Run reference tests of the deformable soil");
  command->require_subcommand(1);
  register_soil_subcommands(*command, program);
}

}  // namespace screed
