// `screed manual`: the man pages of the program.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "tools/command_line/suggestion.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/manual/roff_page.h"

namespace screed {
namespace {

struct ManualArguments {
  std::string subcommand;
  std::optional<std::string> out;
};

const CommandNode& find_subcommand(const CommandNode& root, const std::string& name) {
  std::vector<std::string> names;
  for (const CommandNode& below : root.subcommands) {
    if (below.name == name) return below;
    names.push_back(below.name);
  }
  const std::string nearest = nearest_word(name, names);
  throw InputError("'" + name + "' is no subcommand" +
                   (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
}

void write_all(const CommandNode& root, const std::string& version,
               const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  write_file(folder / (page_name(root) + ".1"), roff_page(root, version));
  for (const CommandNode& below : root.subcommands)
    write_file(folder / (page_name(below) + ".1"), roff_page(root, below, version));
}

}  // namespace

void register_manual_command(Command& root, Program& program) {
  Command* command = root.add_subcommand(
      "manual", "Print the man page of screed or of a subcommand: screed manual sim | man -l -");
  const auto arguments = std::make_shared<ManualArguments>();
  Option* of_one =
      command->add_option("SUBCOMMAND", arguments->subcommand, "Its page (default: screed's own)");
  command->add_option("--out", arguments->out, "Write all pages to this folder")
      ->type_name("FOLDER")
      ->excludes(of_one);
  command->callback([arguments, &root, &program] {
    program.action = [arguments, &root, version = program.version] {
      const CommandNode tree = command_tree(root);
      if (arguments->out.has_value()) {
        write_all(tree, version, *arguments->out);
      } else if (arguments->subcommand.empty()) {
        std::cout << roff_page(tree, version);
      } else {
        std::cout << roff_page(tree, find_subcommand(tree, arguments->subcommand), version);
      }
      return 0;
    };
  });
}

}  // namespace screed
