// Completion of the command line for three shells, as scripts made from the command tree: they call
// nothing and need no other package.
#pragma once

#include <functional>
#include <string>

#include "tools/command_line/command_tree.h"

namespace screed {

std::string bash_completion(const CommandNode& root);
std::string zsh_completion(const CommandNode& root);
std::string fish_completion(const CommandNode& root);

/// What may stand for a value.
enum class ValueKind { kNothing, kChoices, kFolders, kFiles };

inline ValueKind value_kind(const OptionWords& words) {
  if (!words.choices.empty()) return ValueKind::kChoices;
  if (words.value == "NUMBER" || words.value == "INTEGER") return ValueKind::kNothing;
  return words.value == "FOLDER" ? ValueKind::kFolders : ValueKind::kFiles;
}

/// The options that are taken at this node.
inline std::vector<OptionWords> all_options(const CommandNode& node) {
  std::vector<OptionWords> all = node.options;
  all.insert(all.end(), node.inherited.begin(), node.inherited.end());
  return all;
}

/// The node and all below it, in the order of the help.
inline void for_each_node(const CommandNode& node,
                          const std::function<void(const CommandNode&)>& visit) {
  visit(node);
  for (const CommandNode& below : node.subcommands) for_each_node(below, visit);
}

}  // namespace screed
