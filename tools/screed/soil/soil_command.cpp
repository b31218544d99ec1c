// `screed soil`: the reference tests of the deformable soil, each in a file of its own.
#include "commands.h"

namespace screed {

void register_soil_command(Command& root, Program& program) {
  Command* command = root.add_subcommand("soil", "Run reference tests of the deformable soil");
  register_soil_subcommands(*command, program);
}

}  // namespace screed
