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

/// An option, not a negative number.
inline bool is_option(const std::string& word) {
  const bool is_number = word.size() > 1 && (word[1] == '.' || (word[1] >= '0' && word[1] <= '9'));
  return word.size() > 1 && word[0] == '-' && word != "--" && !is_number;
}

inline std::string suggestion(const std::string& mistyped, const std::vector<std::string>& words) {
  const std::string nearest = nearest_word(mistyped, words);
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

inline std::string no_subcommand(const CLI::App& at, const std::string& word) {
  std::vector<std::string> known;
  for (const CLI::App* command : at.get_subcommands({})) known.push_back(command->get_name());
  return "'" + word + "' is no subcommand" + suggestion(word, known);
}

/// What is wrong with a command line: the parser's words, or a word that is no subcommand or no
/// option; and the word that was probably meant.
inline std::string wrong_command_line(const CLI::App& app, const CLI::ParseError& error) {
  // Others name a value. One that misses a word may have come to it by a word that is too many.
  const bool of_a_word = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                         dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  const std::vector<std::string> unknown = app.remaining(true);
  if (!of_a_word || unknown.empty()) return error.what();
  const CLI::App* at = &app;
  while (!at->get_subcommands().empty()) at = at->get_subcommands().back();
  const std::string& word = unknown.front();
  if (is_option(word)) {
    std::vector<std::string> known;
    for (const CLI::Option* option : at->get_options()) {
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    }
    const std::string name = word.substr(0, word.find('='));
    return "'" + name + "' is no option" + suggestion(name, known);
  }
  if (at->get_require_subcommand_min() > 0) return no_subcommand(*at, word);
  return error.what();
}

/// Of a command line whose first words are to lead to a subcommand: what is wrong with the word
/// that leads to none; empty: nothing. The parser looks at --help first.
inline std::string wrong_word(const CLI::App& app, const std::vector<std::string>& arguments) {
  const CLI::App* at = &app;
  std::string path = app.get_name();
  for (const std::string& word : arguments) {
    if (is_option(word) || at->get_require_subcommand_min() == 0) break;
    const auto below =
        at->get_subcommands([&](const CLI::App* command) { return command->check_name(word); });
    if (below.empty()) return no_subcommand(*at, word) + " (see " + path + " --help)";
    at = below.front();
    path += " " + word;
  }
  return "";
}

/// `screed help sim` is `screed sim --help`. Arguments without the program's name.
inline std::vector<std::string> arguments_of(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  if (!arguments.empty() && arguments.front() == "help") {
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
  }
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
    std::vector<std::string> arguments = arguments_of(argc, argv);
    if (const std::string wrong = wrong_word(app, arguments); !wrong.empty())
      return fail(kWrongInput, wrong);
    std::reverse(arguments.begin(), arguments.end());  // as the parser takes them
    app.parse(arguments);
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
