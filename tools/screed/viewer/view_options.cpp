// Options of the viewer.
#include "tools/screed/viewer/view_options.h"

#include <cstdio>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

void read_size(const std::string& text, viewer::ViewerOptions& options) {
  constexpr int kMost = 8000;
  int width = 0;
  int height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) != 2 ||
      width < viewer::Drawing::kLeastWidth || height < viewer::Drawing::kLeastHeight ||
      width > kMost || height > kMost) {
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
                  "simulated seconds a second, 0.01 to 1000; 0: as fast as it goes (default: 1)")
      ->group(kGroup)
      ->check(CLI::Range(0.0, 1000.0));
  command.add_option("--screenshot", arguments.screenshot, "write a picture of the viewer, PNG")
      ->group(kGroup);
  command
      .add_option("--at", arguments.at,
                  "the time the screenshot shows, simulated seconds (default: the end)")
      ->group(kGroup)
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--film", arguments.film,
                  "folder for PNGs of the whole run: a film of 25 frames a second, at --speed")
      ->group(kGroup);
  command.add_option("--shading", arguments.shading, "what the colours of the ground say at first")
      ->group(kGroup)
      ->check(CLI::IsMember({"height", "slope", "change"}))
      ->capture_default_str();
  command.add_option("--span", arguments.span_m, "width of the ground seen at first, m")
      ->group(kGroup)
      ->check(CLI::Range(0.05, 1000.0));
  command.add_flag("--follow", arguments.follow, "the robot stays in the middle")->group(kGroup);
  command.add_option("--size", arguments.size, "of the window or picture, pixels (1280x800)")
      ->group(kGroup);
  command
      .add_option("--frames", arguments.frames,
                  "show so many frames in the window, each 1/60 s on, as fast as it goes; then "
                  "close it and tell how long they took")
      ->group(kGroup)
      ->check(CLI::PositiveNumber);
  command
      .add_option("--press", arguments.presses,
                  "a key pressed by itself, KEY@SECONDS or KEY@FROM-TO of simulated time, as "
                  "Up@3-5; may be repeated")
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
  options.film = arguments.film;
  options.follow = arguments.follow;
  options.span_m = arguments.span_m;
  if (!arguments.size.empty()) read_size(arguments.size, options);
  if (arguments.shading == "slope") options.shading = viewer::Shading::kSlope;
  if (arguments.shading == "change") options.shading = viewer::Shading::kChange;
  for (const std::string& press : arguments.presses) {
    options.script.push_back(viewer::parse_scripted_key(press));
  }
  // Keys alone drive as well, unseen.
  if (!window && arguments.screenshot.empty() && arguments.film.empty() && options.script.empty())
    return std::nullopt;
  return options;
}

}  // namespace screed
