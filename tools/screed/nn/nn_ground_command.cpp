// `screed nn ground`: the stand-in's ground below recorded drives, beside the recorded one.
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/core/statistics.h"
#include "nn/surrogate/ground_check.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

struct GroundArguments {
  std::vector<std::string> sessions;
  double seconds = 600.0;
};

int run_ground(const GroundArguments& arguments) {
  constexpr double kPercent = 100.0;
  std::printf("  %-24s %8s %12s %12s %8s %12s %12s %8s %8s\n", "session", "s", "change, mm",
              "error, mm", "share", "moved, cm3", "stand-in", "share", "lost");
  std::vector<double> errors;
  std::vector<double> moved;
  for (const std::string& folder : arguments.sessions) {
    ProgressBar bar(std::cerr);
    const nn::GroundCheck check = nn::check_ground(
        folder, arguments.seconds,
        [&](std::string_view task, double share) { bar.show_share(share, std::string(task)); });
    bar.clear();
    errors.push_back(kPercent * check.error_mm / check.change_mm);
    moved.push_back(kPercent * check.standin_moved_cm3 / check.moved_cm3);
    std::printf("  %-24s %8.1f %12.3f %12.3f %7.1f%% %12.1f %12.1f %7.1f%% %8lld\n",
                check.source.c_str(), check.driven_s, check.change_mm, check.error_mm,
                errors.back(), check.moved_cm3, check.standin_moved_cm3, moved.back(),
                static_cast<long long>(check.volume_error));
    std::fflush(stdout);
  }
  std::printf(
      "\n  of %zu sessions: error %.1f%% of the change in the median, %.1f%% at worst; "
      "moved %.1f%% in the median, %.1f%% to %.1f%%\n",
      errors.size(), quantile(errors, 0.5), quantile(errors, 1.0), quantile(moved, 0.5),
      quantile(moved, 0.0), quantile(moved, 1.0));
  return 0;
}

}  // namespace

void register_nn_ground_command(Command& nn, Program& program) {
  auto ground = std::make_shared<GroundArguments>();
  Command* command = nn.add_subcommand(
      "ground", "Compare the ground that the stand-in leaves below recorded drives");
  command->add_option("SESSION", ground->sessions, "Run folders of screed record")->required();
  add_number(*command, "--seconds", ground->seconds, "How long to follow each drive [s]",
             {1.0, 1e5});
  command->callback(
      [ground, &program] { program.action = [ground] { return run_ground(*ground); }; });
}

}  // namespace screed
