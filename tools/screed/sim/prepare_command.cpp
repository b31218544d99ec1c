// `screed prepare FILE`: an experiment as the bytes of a world, for programs that have no files of
// it.
#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/world/world_setup.h"
#include "host_sim/standin/standin_plant.h"
#include "tools/screed/cli/command.h"

namespace screed {
namespace {

struct PrepareArguments {
  std::string file;
  std::vector<std::string> sets;
  std::string out;
};

int run_prepare(const PrepareArguments& arguments) {
  const std::string bytes =
      to_bytes(prepare_standin(read_experiment(arguments.file, arguments.sets)));
  AtomicFile file(arguments.out);
  file.write(bytes);
  file.commit();
  std::cerr << arguments.out << ": " << bytes.size() << " bytes\n";
  return 0;
}

}  // namespace

void register_prepare_command(Command& root, Program& program) {
  auto [command, arguments] = add_subcommand<PrepareArguments>(
      root, program, "prepare",
      "Write the world of an experiment to one file, for the C library libscreed-core",
      run_prepare);
  command
      .add_option("FILE", arguments.file, "Experiment; `screed sim --help` says how it is found")
      ->required();
  command.add_option("--set", arguments.sets, "Override a key; may be repeated")
      ->type_name("SECTION.KEY=VALUE");
  command.add_option("--out", arguments.out, "File to write")->type_name("FILE")->required();
}

}  // namespace screed
