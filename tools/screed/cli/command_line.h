// The command line of `screed` with every subcommand, as the program has it and as tests look at
// it.
#pragma once

#include <string>

#include "commands.h"

namespace screed {

struct CommandLine {
  Command app{"Screed: firmware for a terrain-leveling robot, and its simulation twin", "screed"};
  Program program;

  /// `version` is recorded in sessions; `version_text` is what --version prints.
  CommandLine(const std::string& version, const std::string& version_text) : program{version, {}} {
    app.option("--help")->help_text("Show this help and exit");
    app.set_version_flag("--version", version_text, "Show version, commit and date, and exit");
    register_screed_subcommands(app, program);
  }
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;
};

}  // namespace screed
