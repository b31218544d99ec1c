// `screed`, the one host program: subcommands, and how they end. Exit codes: 0 done, 1 the run
// failed, 2 the input was wrong.
#include <CLI/CLI.hpp>
#include <exception>
#include <functional>
#include <iostream>

#include "host_sim/core/errors.h"
#include "tools/attitude_command.h"
#include "tools/grid_command.h"
#include "tools/parity_command.h"
#include "tools/replay_command.h"
#include "tools/sim_command.h"
#include "tools/soil_command.h"
#include "version.h"

int main(int argc, char** argv) {
  constexpr int kFailed = 1;
  constexpr int kWrongInput = 2;
  try {
    CLI::App app("Screed: firmware for a terrain-leveling robot, and its simulation twin",
                 "screed");
    app.set_version_flag("--version", SCREED_VERSION);
    app.require_subcommand(1);
    std::function<int()> action;
    screed::register_sim_command(app, SCREED_VERSION, action);
    screed::register_replay_command(app, action);
    screed::register_parity_command(app, action);
    screed::register_attitude_command(app, action);
    screed::register_grid_command(app, SCREED_VERSION, action);
    screed::register_soil_command(app, action);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
      std::cerr << "screed: " << error.what() << " (see screed --help)\n";
      return kWrongInput;
    }
    return action();
  } catch (const screed::InputError& error) {
    std::cerr << "screed: " << error.what() << "\n";
    return kWrongInput;
  } catch (const std::exception& error) {
    std::cerr << "screed: " << error.what() << "\n";
    return kFailed;
  }
}
