// `screed manual`: the man pages of the program (man(7)), made from its command line.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "tools/command_line/program.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/manual/manual.h"

namespace screed {
namespace {

/// "screed-session" of "screed session": what the page is called.
std::string page_name(const CommandNode& node) {
  std::string name = node.path;
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

/// Text of a line of its own.
std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\\') {
      safe += "\\e";
    } else if (c == '-') {
      safe += "\\-";
    } else {
      safe += c;
    }
  }
  const bool is_request = !safe.empty() && (safe[0] == '.' || safe[0] == '\'');
  return is_request ? "\\&" + safe : safe;
}

std::string bold(const std::string& text) {
  return "\\fB" + escaped(text) + "\\fR";
}
std::string italic(const std::string& text) {
  return "\\fI" + escaped(text) + "\\fR";
}

std::string head(const CommandNode& node, const std::string& version) {
  std::string title = page_name(node);
  std::transform(title.begin(), title.end(), title.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return ".\\\" Made by `screed manual`.\n.TH \"" + escaped(title) + "\" 1 \"\" \"screed " +
         escaped(version) + "\" \"Screed\"\n.SH NAME\n" + escaped(page_name(node)) + " \\- " +
         escaped(node.help) + "\n";
}

std::string synopsis(const CommandNode& node) {
  return bold(node.path) + escaped(node.usage().substr(node.path.size())) + "\n";
}

std::string item(const OptionWords& words) {
  std::string tag;
  for (const std::string& name : words.names) {
    tag += tag.empty() ? "" : ", ";
    tag += words.is_positional ? italic(name) : bold(name);
  }
  if (words.is_positional) {
    tag += words.repeated ? "..." : "";
  } else if (!words.value.empty()) {
    tag += " " + italic(words.value);
  }
  const std::string more = details(words);
  return ".TP\n" + tag + "\n" + escaped(words.help + (more.empty() ? "" : " " + more)) + "\n";
}

std::string items(const std::vector<OptionWords>& all) {
  std::string text;
  for (const OptionWords& words : all) text += item(words);
  return text;
}

/// Subcommands with their own options, and those below them.
std::string sections(const CommandNode& node) {
  std::string text;
  for (const CommandNode& below : node.subcommands) {
    text += ".SS \"" + escaped(below.path) + "\"\n" + synopsis(below) + ".PP\n" +
            escaped(below.help) + "\n" + items(below.arguments) + items(below.options) +
            sections(below);
  }
  return text;
}

std::string section(const char* heading, const std::string& text) {
  return text.empty() ? "" : std::string(".SH ") + heading + "\n" + text;
}

constexpr const char* kExitStatus =
    ".TP\n0\ndone\n.TP\n1\nthe run failed or ended before its time, or a robot refused\n"
    ".TP\n2\nthe input is wrong; one line on standard error says what, where, and what is allowed\n"
    ".TP\n128 + N\nsignal N ended a run\n";

constexpr const char* kEnvironment =
    ".TP\n\\fBSCREED_DATA\\fR\nfolder with experiments, boards and models, in place of those that "
    "came with the program\n"
    ".TP\n\\fBSCREED_THREADS\\fR\nthreads that compute a bed of particles; 1 when it is not set. "
    "Results do not depend on it\n"
    ".TP\n\\fBXDG_CONFIG_HOME\\fR\nfolder of the user's configurations, "
    "\\fI~/.config\\fR when it is not set\n";

constexpr const char* kFiles =
    ".TP\n\\fI~/.config/screed/link.ini\\fR\nthe link and the key file that "
    "\\fB\\-\\-remember\\fR has kept\n";

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
  throw InputError("'" + name + "' is no subcommand" + did_you_mean(name, names));
}

void write_all(const CommandNode& root, const std::string& version,
               const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  write_file(folder / (page_name(root) + ".1"), roff_page(root, version));
  for (const CommandNode& below : root.subcommands)
    write_file(folder / (page_name(below) + ".1"), roff_page(root, below, version));
}

int run_manual(const ManualArguments& arguments, const CommandNode& tree,
               const std::string& version) {
  if (arguments.out.has_value()) {
    write_all(tree, version, *arguments.out);
  } else if (arguments.subcommand.empty()) {
    std::cout << roff_page(tree, version);
  } else {
    std::cout << roff_page(tree, find_subcommand(tree, arguments.subcommand), version);
  }
  return 0;
}

}  // namespace

std::string roff_page(const CommandNode& root, const std::string& version) {
  std::string list;
  std::string see_also;
  for (const CommandNode& below : root.subcommands) {
    list += ".TP\n" + bold(below.name) + "\n" + escaped(below.help) + "\n";
    see_also += (see_also.empty() ? "" : ",\n") + bold(page_name(below)) + "(1)";
  }
  return head(root, version) + section("SYNOPSIS", synopsis(root)) +
         section("OPTIONS", items(root.options)) + section("SUBCOMMANDS", list) +
         section("EXIT STATUS", kExitStatus) + section("ENVIRONMENT", kEnvironment) +
         section("FILES", kFiles) + section("SEE ALSO", see_also + "\n");
}

std::string roff_page(const CommandNode& root, const CommandNode& subcommand,
                      const std::string& version) {
  return head(subcommand, version) + section("SYNOPSIS", synopsis(subcommand)) +
         section("ARGUMENTS", items(subcommand.arguments)) +
         section("OPTIONS", items(subcommand.options)) +
         section("SUBCOMMANDS", sections(subcommand)) + section("EXIT STATUS", kExitStatus) +
         section("SEE ALSO", bold(page_name(root)) + "(1)\n");
}

void register_manual_command(Command& root, Program& program) {
  auto [command, arguments] = add_subcommand<ManualArguments>(
      root, program, "manual",
      "Print the man page of screed or of a subcommand: screed manual sim | man -l -",
      [&root](const ManualArguments& given, const std::string& version) {
        return run_manual(given, command_tree(root), version);
      });
  Option* of_one =
      command.add_option("SUBCOMMAND", arguments.subcommand, "Its page (default: screed's own)");
  command.add_option("--out", arguments.out, "Write all pages to this folder")
      ->type_name("FOLDER")
      ->excludes(of_one);
}

}  // namespace screed
