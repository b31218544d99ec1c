// `screed replay RUN`: does this build still compute what was recorded? Exit codes: 0 the outputs
// are identical, 1 they differ, 2 wrong RUN.
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "host_sim/core/figures.h"
#include "host_sim/core/json.h"
#include "host_sim/run/session/replay.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/session/session_layout.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/task_bar.h"

namespace screed {
namespace {

struct ReplayOptions {
  std::string run;
  bool json = false;
};

Json json_of(const std::string& run, const ReplayResult& result) {
  const bool differs = result.first_difference_tick.has_value();
  return {{"run", run},
          {"ticks", result.ticks},
          {"identical", !differs},
          {"first_difference_tick", differs ? Json(*result.first_difference_tick) : Json()},
          {"first_difference", differs ? Json(result.first_difference) : Json()},
          {"output_hash", result.output_hash},
          {"complete", result.complete},
          {"unchanged", result.unchanged}};
}

/// The first robot of a run, with the others, if there are any, as a list.
void print_json(const std::string& run, const std::vector<ReplayResult>& results) {
  Json json = json_of(run, results.front());
  for (size_t i = 1; i < results.size(); ++i) {
    json["further_robots"].push_back(json_of(folder_of_robot(run, i).string(), results[i]));
  }
  print_json(json, -1);
}

void print_text(const std::string& of, const ReplayResult& result) {
  std::cout << of << result.ticks << " ticks replayed, ";
  if (result.first_difference_tick) {
    std::cout << "first difference at tick " << *result.first_difference_tick << ": "
              << result.first_difference << "\n";
  } else {
    std::cout << "outputs identical\n";
  }
}

void print_notes(const std::string& of, const ReplayResult& result) {
  if (!result.complete) {
    std::cerr << "note: " << of
              << "the recorded run did not end; only its saved ticks were replayed\n";
  }
  if (result.arithmetic != arithmetic()) {
    std::cerr << "note: " << of << "the world was computed with arithmetic '" << result.arithmetic
              << "', not this program's '" << arithmetic()
              << "': its experiment run again gives other bits\n";
  }
  if (!result.unchanged) {
    std::cerr << "note: " << of << "the session does not have the content it was saved with\n";
  }
}

int replay_run(const ReplayOptions& options) {
  const std::vector<std::filesystem::path> files = session_files(options.run);
  std::vector<ReplayResult> results;
  bool identical = true;
  TaskBar bar(options.json);
  for (size_t i = 0; i < files.size(); ++i) {
    const ReplayResult& result = results.emplace_back(replay_session(files[i], bar.progress()));
    identical = identical && !result.first_difference_tick;
    bar.clear();
    const std::string of = files.size() > 1 ? "robot " + std::to_string(i) + ": " : "";
    print_notes(of, result);
    if (!options.json) print_text(of, result);
  }
  if (options.json) print_json(options.run, results);
  return identical ? 0 : 1;
}

}  // namespace

void register_replay_command(Command& root, Program& program) {
  auto [command, options] = add_subcommand<ReplayOptions>(
      root, program, "replay",
      "Feed a recorded run to the firmware again and compare its outputs byte for byte",
      replay_run);
  command.add_option("RUN", options.run, "Run folder or session.h5")->required();
  command.add_flag("--json", options.json, "Print the result as JSON");
}

}  // namespace screed
