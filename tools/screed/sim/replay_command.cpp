// `screed replay RUN`: does this build still compute what was recorded? Exit codes: 0 the outputs
// are identical, 1 they differ, 2 wrong RUN.
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "host_sim/run/session/replay.h"
#include "host_sim/run/session/run_folder.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/task_bar.h"

namespace screed {
namespace {

struct Options {
  std::string run;
  bool json = false;
};

void print_json(const std::string& run, const ReplayResult& result) {
  nlohmann::ordered_json json;
  json["run"] = run;
  json["ticks"] = result.ticks;
  json["identical"] = !result.first_difference_tick;
  json["first_difference_tick"] = nullptr;
  json["first_difference"] = nullptr;
  if (result.first_difference_tick) {
    json["first_difference_tick"] = *result.first_difference_tick;
    json["first_difference"] = result.first_difference;
  }
  json["output_hash"] = result.output_hash;
  json["complete"] = result.complete;
  json["unchanged"] = result.unchanged;
  // A path need not be UTF-8; JSON must.
  std::cout << json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << "\n";
}

void print_text(const ReplayResult& result) {
  std::cout << result.ticks << " ticks replayed, ";
  if (result.first_difference_tick) {
    std::cout << "first difference at tick " << *result.first_difference_tick << ": "
              << result.first_difference << "\n";
  } else {
    std::cout << "outputs identical\n";
  }
}

int run_replay(const Options& options) {
  TaskBar bar(options.json);
  const ReplayResult result = replay_session(session_file(options.run), bar.progress());
  bar.clear();
  if (!result.complete) {
    std::cerr << "note: the recorded run did not end; only its saved ticks were replayed\n";
  }
  if (!result.unchanged) {
    std::cerr << "note: the session does not have the content it was saved with\n";
  }
  if (options.json) {
    print_json(options.run, result);
  } else {
    print_text(result);
  }
  return result.first_difference_tick ? 1 : 0;
}

}  // namespace

void register_replay_command(CLI::App& root, Program& program) {
  CLI::App* command = root.add_subcommand(
      "replay", "Feed a recorded run to the firmware again and compare its outputs byte for byte");
  const auto options = std::make_shared<Options>();
  command->add_option("RUN", options->run, "Run folder or session.h5")->required();
  command->add_flag("--json", options->json, "Print the result as JSON");
  command->callback(
      [options, &program] { program.action = [options] { return run_replay(*options); }; });
}

}  // namespace screed
