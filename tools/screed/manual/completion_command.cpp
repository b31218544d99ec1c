// `screed completion`: a script that completes this command line in a shell.
#include <iostream>
#include <memory>
#include <string>

#include "tools/screed/cli/command.h"
#include "tools/screed/manual/shell_completion.h"

namespace screed {

void register_completion_command(Command& root, Program& program) {
  Command* command = root.add_subcommand(
      "completion", "Print a script that completes screed's command line in a shell");
  const auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "The shell, as in: source <(screed completion bash)")
      ->required()
      ->one_of({"bash", "zsh", "fish"});
  command->callback([shell, &root, &program] {
    program.action = [shell, &root] {
      const CommandNode tree = command_tree(root);
      std::cout << (*shell == "bash"  ? bash_completion(tree)
                    : *shell == "zsh" ? zsh_completion(tree)
                                      : fish_completion(tree));
      return 0;
    };
  });
}

}  // namespace screed
