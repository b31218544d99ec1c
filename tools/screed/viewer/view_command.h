// `screed view`, and what the user may say about pictures of a run: for `screed sim` as well.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/command_line/command.h"
#include "tools/screed/viewer/viewer_display.h"

namespace screed {

/// As the user says it: what the viewer takes as it is, and what is read.
struct ViewArguments {
  viewer::ViewerOptions options;
  std::optional<double> speed;
  std::string shading = "height";
  std::optional<std::string> size;
  std::vector<std::string> key_script;
};

void add_view_options(Command& command, ViewArguments& arguments);

/// What they come to; nothing when there is neither a window nor a picture to be made. Without
/// `window` pictures are drawn without one. Throws InputError.
std::optional<viewer::ViewerOptions> viewer_options(const ViewArguments& arguments, bool window);

}  // namespace screed
