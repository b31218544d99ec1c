// How every host program ends: 0 done, 1 the run failed, 2 the input was wrong, and then one line
// on standard error says what. Header only: the smaller programs link without the library.
#pragma once

#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <iostream>
#include <string>

#include "host_sim/core/errors.h"

namespace screed {

/// The program and the subcommand that its command line has come to: "screed session export".
inline std::string command_name(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* at = &app; !at->get_subcommands().empty();) {
    at = at->get_subcommands().back();
    name += " " + at->get_name();
  }
  return name;
}

/// Parses the command line into `app`, then runs `body`, which returns the exit code. `app` must
/// carry the program's name.
template <class Body>
int run_program(CLI::App& app, int argc, char** argv, Body body) {
  constexpr int kFailed = 1;
  constexpr int kWrongInput = 2;
  const auto fail = [&](int code, const std::string& what) {
    std::cerr << app.get_name() << ": " << what << "\n";
    return code;
  };
  std::signal(SIGXFSZ, SIG_IGN);  // past a limit of file sizes a write fails, as on a full disk
  try {
    app.parse(argc, argv);
    return body();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return fail(kWrongInput, std::string(error.what()) + " (see " + command_name(app) + " --help)");
  } catch (const InputError& error) {
    return fail(kWrongInput, error.what());
  } catch (const std::exception& error) {
    return fail(kFailed, error.what());
  }
}

}  // namespace screed
