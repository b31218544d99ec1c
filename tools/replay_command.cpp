// Options and results of `screed replay`.
#include "tools/replay_command.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "host_sim/session/replay.h"

namespace screed {
namespace {

struct Options {
  std::string run;
  bool json = false;
};

std::filesystem::path session_file(const std::filesystem::path& run) {
  std::error_code error;
  return std::filesystem::is_directory(run, error) ? run / "session.h5" : run;
}

std::string json_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      std::array<char, 8> code{};
      std::snprintf(code.data(), code.size(), "\\u%04x", static_cast<unsigned>(c));
      quoted += code.data();
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

void print_json(const std::string& run, const ReplayResult& result) {
  const bool identical = !result.first_difference_tick;
  std::cout << "{\"run\":" << json_text(run) << ",\"ticks\":" << result.ticks
            << ",\"identical\":" << (identical ? "true" : "false") << ",\"first_difference_tick\":"
            << (identical ? "null" : std::to_string(*result.first_difference_tick))
            << ",\"first_difference\":" << (identical ? "null" : json_text(result.first_difference))
            << ",\"output_hash\":" << json_text(result.output_hash)
            << ",\"complete\":" << (result.complete ? "true" : "false")
            << ",\"unchanged\":" << (result.unchanged ? "true" : "false") << "}\n";
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
  const ReplayResult result = replay_session(session_file(options.run));
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

void register_replay_command(CLI::App& root, std::function<int()>& action) {
  CLI::App* command = root.add_subcommand(
      "replay", "Feed a recorded run to the firmware again and compare its outputs byte for byte");
  const auto options = std::make_shared<Options>();
  command->add_option("RUN", options->run, "run folder, or a session.h5")->required();
  command->add_flag("--json", options->json, "print the result as JSON");
  command->callback([options, &action] { action = [options] { return run_replay(*options); }; });
}

}  // namespace screed
