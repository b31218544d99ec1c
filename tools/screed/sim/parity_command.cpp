// `screed parity FILE`: does the image compute what the host computes? Exit codes: 0 no byte
// differs, 1 one does, 2 wrong input.
#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/figures.h"
#include "host_sim/core/json.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/parity.h"
#include "host_sim/run/simulation/simulation.h"
#include "host_sim/run/world/image_robot.h"
#include "host_sim/run/world/world_setup.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

struct ParityArguments {
  std::string file;
  std::string board = kDefaultBoard;
  std::optional<std::string> elf;
  double minutes = 1.0;
  std::vector<std::string> sets;
  bool quiet = false;
  bool json = false;
};

Json json_of(const ParityArguments& arguments, const ParityResult& result, double factor) {
  const bool differs = result.first_difference_tick.has_value();
  return {{"experiment", arguments.file},
          {"board", arguments.board},
          {"ticks", result.ticks},
          {"driving_ticks", result.driving_ticks},
          {"compared_bytes", result.compared_bytes},
          {"differing_bytes", result.differing_bytes},
          {"first_difference_tick", differs ? Json(*result.first_difference_tick) : Json()},
          {"first_difference", differs ? Json(result.first_difference) : Json()},
          {"simulated_s", result.simulated_s},
          {"real_time_factor", factor}};
}

void print_parity(const Json& json) {
  print(
      "{experiment} on {board}: {ticks} ticks ({driving_ticks} driving), "
      "{compared_bytes} bytes compared, {differing_bytes} differ\n",
      json);
  if (!json["first_difference"].is_null())
    print("first difference at tick {first_difference_tick}: {first_difference}\n", json);
  print("{simulated_s:.1f} s simulated, real-time factor {real_time_factor:.1f}\n", json);
}

int run_parity_command(const ParityArguments& arguments) {
  const Experiment experiment = read_experiment(arguments.file, arguments.sets);
  const bool quiet = arguments.quiet || arguments.json;
  TaskBar setup_bar(quiet);
  const std::unique_ptr<World> world =
      make_world(experiment, {.board = arguments.board,
                              .image = arguments.elf.value_or(default_image(arguments.board)),
                              .progress = setup_bar.progress()});
  setup_bar.clear();
  std::optional<ProgressBar> bar;
  if (!quiet) bar.emplace(std::cerr);
  const double seconds = arguments.minutes * 60.0;
  const auto begin = std::chrono::steady_clock::now();
  const ParityResult result =
      run_parity(*world, world->robot().settings(), seconds, [&](const ParityResult& so_far) {
        if (bar.has_value() && so_far.ticks % kTickRate_hz == 0) {
          bar->show(so_far.simulated_s, seconds,
                    std::to_string(so_far.differing_bytes) + " bytes differ");
        }
        return !interrupted();
      });
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const double factor = wall_s > 0.0 ? result.simulated_s / wall_s : 0.0;
  if (bar.has_value()) bar->finish();
  const Json json = json_of(arguments, result, factor);
  arguments.json ? print_json(json) : print_parity(json);
  if (interrupted()) {
    std::cerr << "note: stopped after " << result.simulated_s << " s of " << seconds << " s\n";
  }
  return result.differing_bytes == 0 ? interrupted_exit_code() : 1;
}

}  // namespace

void register_parity_command(Command& root, Program& program) {
  auto [command, arguments] = add_subcommand<ParityArguments>(
      root, program, "parity",
      "Run the flash image in a simulated world and compare every output byte "
      "with the firmware compiled for this machine. Of several robots the first is the "
      "image",
      run_parity_command);
  command.add_option("FILE", arguments.file, "Experiment file (INI)")->required();
  command.add_option("--board", arguments.board,
                     std::string("Board: a folder in boards/ (default: ") + kDefaultBoard + ")");
  command.add_option("--elf", arguments.elf, "ELF image (default: the one of make firmware)")
      ->type_name("FILE");
  add_number(command, "--minutes", arguments.minutes, "Simulated time [min] (default: 1)",
             {0.01, 10000.0});
  command.add_option("--set", arguments.sets, "Override a key: section.key=value")
      ->type_name("KEY=VALUE")
      ->one_value_each();
  command.add_flag("--quiet", arguments.quiet, "Show no progress");
  command.add_flag("--json", arguments.json, "Print the result as JSON");
}

}  // namespace screed
