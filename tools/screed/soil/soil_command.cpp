// `screed soil`: its subcommands, each in a file of its own.
#include "tools/screed/soil/soil_command.h"

#include "tools/screed/soil/soil_common.h"

namespace screed {

void register_soil_command(CLI::App& root, std::function<int()>& action) {
  CLI::App* command = root.add_subcommand("soil", "Run reference tests of the deformable soil");
  command->require_subcommand(1);
  add_soil_plate(*command, action);
  add_soil_wheel(*command, action);
  add_soil_robot(*command, action);
  add_soil_repose(*command, action);
  add_soil_dig(*command, action);
  add_soil_match(*command, action);
}

}  // namespace screed
