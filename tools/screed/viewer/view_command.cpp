// `screed view RUN`: looks at a recorded run, or a robot's log, at any time of it; and options of
// the viewer.
#include "tools/screed/viewer/view_command.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/scene/log_session.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/viewer/run_viewers.h"

namespace screed {
namespace {

std::string size_range() {
  const std::string most = std::to_string(viewer::kMaxWindowSide_px);
  return std::to_string(viewer::kMinWindowWidth_px) + "x" +
         std::to_string(viewer::kMinWindowHeight_px) + " to " + most + "x" + most;
}

void read_size(const std::string& text, viewer::ViewerOptions& options) {
  const auto [width, height] = whole_pair(text).value_or(std::pair(0, 0));
  if (width < viewer::kMinWindowWidth_px || height < viewer::kMinWindowHeight_px ||
      width > viewer::kMaxWindowSide_px || height > viewer::kMaxWindowSide_px) {
    throw InputError("--size = '" + text + "' is not allowed; expected WIDTHxHEIGHT, " +
                     size_range() + " pixels");
  }
  options.width_px = width;
  options.height_px = height;
}

/// Makes the file, and missing folders above it, and removes them again, before the run: a picture
/// that cannot be written at its end would be lost.
void check_writable(const std::string& option, const std::filesystem::path& file,
                    bool make_folder) {
  try {
    MadeFolders folders;
    if (make_folder) folders.make(file.parent_path());
    const AtomicFile probe(file);
  } catch (const RunError& error) {
    throw InputError(option + ": " + error.what());
  }
}

void check_screenshot(const std::string& file) {
  namespace fs = std::filesystem;
  const fs::path path(file);
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), ::tolower);
  if (extension != ".png") {
    throw InputError("--screenshot = '" + file +
                     "' is not allowed; expected a file that ends in .png, the only format");
  }
  if (path.has_parent_path() && !fs::is_directory(path.parent_path())) {
    throw InputError("--screenshot = '" + file + "': there is no folder '" +
                     path.parent_path().string() + "'");
  }
  check_writable("--screenshot", path, false);
}

/// Frames of two films must not mix.
void check_frames_folder(const std::string& folder) {
  namespace fs = std::filesystem;
  if (fs::exists(folder) && !fs::is_directory(folder))
    throw InputError("--frames-dir = '" + folder + "' is no folder");
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("frame_", 0) != 0 || entry.path().extension() != ".png") continue;
    throw InputError("--frames-dir = '" + folder +
                     "' holds frames of another film (frame_*.png); " +
                     "remove them or name another folder");
  }
  check_writable("--frames-dir", fs::path(folder) / "frame_000001.png", true);
}

}  // namespace

void add_view_options(Command& command, ViewArguments& arguments) {
  const char* const kGroup = "Viewer";
  add_number(command, "--speed", arguments.speed,
             "Speed [simulated s / s]; 0: as fast as possible (default: 1)",
             {.low = 0.01, .high = 1000.0, .or_zero = true})
      ->group(kGroup);
  command
      .add_option("--screenshot", arguments.options.screenshot,
                  "Write a screenshot of the viewer to this PNG file")
      ->type_name("FILE")
      ->group(kGroup);
  add_number(command, "--at", arguments.options.screenshot_at,
             "Time of the screenshot [simulated s] (default: the end)", {0.0, 1e6})
      ->group(kGroup);
  command
      .add_option("--frames-dir", arguments.options.frames_dir,
                  "Write PNG frames of the whole run to this folder, 25 frames/s at --speed")
      ->type_name("FOLDER")
      ->group(kGroup);
  command.add_option("--shading", arguments.shading, "Initial colouring of the terrain")
      ->group(kGroup)
      ->one_of({"height", "slope", "change"})
      ->show_default();
  add_number(command, "--span", arguments.options.span_m, "Initial width of the view [m]",
             {0.05, 1000.0})
      ->group(kGroup);
  command.add_flag("--follow", arguments.options.follow, "Keep the robot in the centre")
      ->group(kGroup);
  command
      .add_option("--size", arguments.size,
                  "Size of the window or picture, WIDTHxHEIGHT [px] (" + size_range() +
                      "; default: 1280x800)")
      ->group(kGroup);
  add_number(command, "--frames", arguments.options.frames,
             "Show this number of frames, 1/60 s apart, as fast as possible, then exit and "
             "print the timing",
             kCountRange)
      ->group(kGroup);
  command
      .add_option("--key-script", arguments.key_script,
                  "Scripted key press, KEY@SECONDS or KEY@FROM-TO [simulated s], e.g. Up@3-5; may "
                  "be repeated")
      ->group(kGroup)
      ->one_value_each();
}

std::optional<viewer::ViewerOptions> viewer_options(const ViewArguments& arguments, bool window) {
  viewer::ViewerOptions options = arguments.options;
  options.window = window || options.frames.has_value();
  if (options.screenshot_at.has_value() && options.screenshot.empty())
    throw InputError("--at needs --screenshot FILE");
  if (!options.screenshot.empty()) check_screenshot(options.screenshot);
  if (!options.frames_dir.empty()) check_frames_folder(options.frames_dir);
  options.pace = arguments.speed.value_or(1.0);
  if (arguments.size.has_value()) read_size(*arguments.size, options);
  if (arguments.shading == "slope") options.shading = viewer::Shading::kSlope;
  if (arguments.shading == "change") options.shading = viewer::Shading::kChange;
  for (const std::string& press : arguments.key_script) {
    options.script.push_back(viewer::parse_scripted_key(press));
  }
  // Keys alone drive as well, unseen.
  if (!options.window && options.screenshot.empty() && options.frames_dir.empty() &&
      options.script.empty())
    return std::nullopt;
  return options;
}

namespace {

struct Options {
  std::string run;
  std::string board = kDefaultBoard;
  ViewArguments view;
};

int run_view(const Options& options) {
  // A picture or frames are made without a window.
  const viewer::ViewerOptions& asked = options.view.options;
  const bool window = asked.screenshot.empty() && asked.frames_dir.empty();
  viewer::ViewerOptions shown = viewer_options(options.view, window).value();
  TaskBar bar(false);
  shown.progress = bar.progress();
  const ShownRun run(options.run, options.board);
  viewer::RecordedViewer viewer(run.path(), shown);
  viewer.run();
  bar.clear();
  if (asked.frames.has_value()) std::cerr << viewer.times().text() << "\n";
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
