// SVG text to a PNG file.
#pragma once

#include <filesystem>
#include <string>

namespace screed {

/// Draws an SVG at `scale` pixels for each of its own. Throws RunError when it cannot be drawn or
/// written.
void write_svg_as_png(const std::filesystem::path& path, const std::string& svg,
                      double scale = 2.0);

}  // namespace screed
