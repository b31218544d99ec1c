// Options of the viewer.
#include "tools/screed/viewer/view_options.h"

#include <cstdio>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

void read_size(const std::string& text, viewer::ViewerOptions& options) {
  constexpr int kMax = 8000;
  int width = 0;
  int height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) != 2 ||
      width < viewer::Drawing::kMinWidth || height < viewer::Drawing::kMinHeight || width > kMax ||
      height > kMax) {
    throw InputError("--size = '" + text + "' is not allowed; expected WIDTHxHEIGHT, 640x420 to " +
                     "8000x8000 pixels");
  }
  options.width_px = width;
  options.height_px = height;
}

}  // namespace

void add_view_options(CLI::App& command, ViewArguments& arguments) {
  const char* const kGroup = "Viewer";
  command
      .add_option("--speed", arguments.speed,
                  "Speed [simulated s / s], 0.01 to 1000; 0: as fast as possible (default: 1)")
      ->group(kGroup)
      ->check(CLI::Range(0.0, 1000.0));
  command
      .add_option("--screenshot", arguments.screenshot,
                  "Write a screenshot of the viewer to this PNG file")
      ->group(kGroup);
  command
      .add_option("--at", arguments.at, "Time of the screenshot [simulated s] (default: the end)")
      ->group(kGroup)
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--frames-dir", arguments.frames_dir,
                  "Write PNG frames of the whole run to this folder, 25 frames/s at --speed")
      ->group(kGroup);
  command.add_option("--shading", arguments.shading, "Initial colouring of the terrain")
      ->group(kGroup)
      ->check(CLI::IsMember({"height", "slope", "change"}))
      ->capture_default_str();
  command.add_option("--span", arguments.span_m, "Initial width of the view [m]")
      ->group(kGroup)
      ->check(CLI::Range(0.05, 1000.0));
  command.add_flag("--follow", arguments.follow, "Keep the robot in the centre")->group(kGroup);
  command
      .add_option("--size", arguments.size,
                  "Size of the window or picture [px] (default: 1280x800)")
      ->group(kGroup);
  command
      .add_option("--frames", arguments.frames,
                  "Show this number of frames, 1/60 s apart, as fast as possible, then exit and "
                  "print the timing")
      ->group(kGroup)
      ->check(CLI::PositiveNumber);
  command
      .add_option("--key-script", arguments.key_script,
                  "Scripted key press, KEY@SECONDS or KEY@FROM-TO [simulated s], e.g. Up@3-5; may "
                  "be repeated")
      ->group(kGroup)
      ->type_size(1)
      ->allow_extra_args(false);
}

std::optional<viewer::ViewerOptions> viewer_options(const ViewArguments& arguments, bool window) {
  window = window || arguments.frames.has_value();
  if (arguments.at.has_value() && arguments.screenshot.empty())
    throw InputError("--at needs --screenshot FILE");
  viewer::ViewerOptions options;
  options.window = window;
  options.pace = arguments.speed.value_or(1.0);
  options.frames = arguments.frames;
  options.screenshot = arguments.screenshot;
  options.screenshot_at = arguments.at;
  options.frames_dir = arguments.frames_dir;
  options.follow = arguments.follow;
  options.span_m = arguments.span_m;
  if (!arguments.size.empty()) read_size(arguments.size, options);
  if (arguments.shading == "slope") options.shading = viewer::Shading::kSlope;
  if (arguments.shading == "change") options.shading = viewer::Shading::kChange;
  for (const std::string& press : arguments.key_script) {
    options.script.push_back(viewer::parse_scripted_key(press));
  }
  // Keys alone drive as well, unseen.
  if (!window && arguments.screenshot.empty() && arguments.frames_dir.empty() &&
      options.script.empty())
    return std::nullopt;
  return options;
}

}  // namespace screed
