// How every host program ends: 0 done, 1 the run failed, 2 the input was wrong, and then one line
// on standard error says what. Header only: the smaller programs link without the library.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tools/screed/cli/help_format.h"
#include "tools/screed/cli/suggestion.h"

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

/// What is wrong with a command line: the parser's words, or a word that is no subcommand; and the
/// word that was probably meant.
inline std::string wrong_command_line(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> unknown = app.remaining(true);
  if (unknown.empty()) return error.what();
  const CLI::App* at = &app;
  while (!at->get_subcommands().empty()) at = at->get_subcommands().back();
  const std::string& word = unknown.front();
  const bool is_option = word.rfind("--", 0) == 0;
  std::vector<std::string> known;
  if (is_option) {
    for (const CLI::Option* option : at->get_options()) {
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    }
  } else {
    for (const CLI::App* command : at->get_subcommands({})) known.push_back(command->get_name());
  }
  const bool no_subcommand = !is_option && at->get_require_subcommand_min() > 0;
  const std::string nearest = nearest_word(word.substr(0, word.find('=')), known);
  return (no_subcommand ? "'" + word + "' is no subcommand" : std::string(error.what())) +
         (nearest.empty() ? "" : "; did you mean " + nearest + "?");
}

/// `screed help sim` is `screed sim --help`. Arguments without the program's name, last first, as
/// the parser takes them.
inline std::vector<std::string> arguments_of(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  if (!arguments.empty() && arguments.front() == "help") {
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
  }
  std::reverse(arguments.begin(), arguments.end());
  return arguments;
}

/// Parses the command line into `app`, then runs `body`, which returns the exit code. `app` must
/// carry the program's name. Its --help has the form of help_format.h.
template <class Body>
int run_program(CLI::App& app, int argc, char** argv, Body body) {
  constexpr int kFailed = 1;
  constexpr int kWrongInput = 2;
  const auto fail = [&](int code, const std::string& what) {
    std::cerr << app.get_name() << ": " << what << "\n";
    return code;
  };
  use_help_format(app);
  std::signal(SIGXFSZ, SIG_IGN);  // past a limit of file sizes a write fails, as on a full disk
  try {
    app.parse(arguments_of(argc, argv));
    return body();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return fail(kWrongInput,
                wrong_command_line(app, error) + " (see " + command_name(app) + " --help)");
  } catch (const InputError& error) {
    return fail(kWrongInput, error.what());
  } catch (const std::exception& error) {
    return fail(kFailed, error.what());
  }
}

}  // namespace screed
