// `screed view RUN`: looks at a recorded run, or a robot's log, at any time of it.
#include <iostream>
#include <memory>
#include <string>

#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/scene/log_session.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/viewer/recorded_viewer.h"
#include "tools/screed/viewer/view_options.h"

namespace screed {
namespace {

struct Options {
  std::string run;
  std::string board = kDefaultBoard;
  ViewArguments view;
};

int run_view(const Options& options) {
  // A picture or frames are made without a window.
  const bool window = options.view.screenshot.empty() && options.view.frames_dir.empty();
  viewer::ViewerOptions shown = viewer_options(options.view, window).value();
  TaskBar bar(false);
  shown.progress = bar.progress();
  const ShownRun run(options.run, options.board);
  viewer::RecordedViewer viewer(run.path(), shown);
  viewer.run();
  bar.clear();
  if (options.view.frames.has_value()) std::cerr << viewer.times().text() << "\n";
  return interrupted_exit_code();
}

}  // namespace

void register_view_command(Command& root, Program& program) {
  Command* command = root.add_subcommand(
      "view", "View a recorded run or a robot's log from above: play it, scrub through it");
  const auto options = std::make_shared<Options>();
  command
      ->add_option("RUN", options->run, "Run folder, session.h5, or log as written by candump -L")
      ->required();
  command->add_option("--board", options->board, "Board of the robots of a log")
      ->type_name("NAME")
      ->show_default();
  add_view_options(*command, options->view);
  command->callback(
      [options, &program] { program.action = [options] { return run_view(*options); }; });
}

}  // namespace screed
