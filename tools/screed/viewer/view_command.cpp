// `screed view RUN`: looks at a recorded run, at any time of it.
#include <iostream>
#include <memory>
#include <string>

#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/task_bar.h"
#include "tools/screed/viewer/recorded_viewer.h"
#include "tools/screed/viewer/view_options.h"

namespace screed {
namespace {

struct Options {
  std::string run;
  ViewArguments view;
};

int run_view(const Options& options) {
  // A picture or frames are made without a window.
  const bool window = options.view.screenshot.empty() && options.view.frames_dir.empty();
  viewer::ViewerOptions shown = viewer_options(options.view, window).value();
  TaskBar bar(false);
  shown.progress = bar.progress();
  viewer::RecordedViewer viewer(options.run, shown);
  viewer.run();
  bar.clear();
  if (options.view.frames.has_value()) std::cerr << viewer.times().text() << "\n";
  return interrupted_exit_code();
}

}  // namespace

void register_view_command(Command& root, Program& program) {
  Command* command =
      root.add_subcommand("view", "View a recorded run from above: play it, scrub through it");
  const auto options = std::make_shared<Options>();
  command->add_option("RUN", options->run, "Run folder or session.h5")->required();
  add_view_options(*command, options->view);
  command->callback(
      [options, &program] { program.action = [options] { return run_view(*options); }; });
}

}  // namespace screed
