// SVG text to a PNG file, and pixels to the bytes of one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace screed {

/// Draws an SVG at `scale` pixels for each of its own. Throws RunError when it cannot be drawn or
/// written.
void write_svg_as_png(const std::filesystem::path& path, const std::string& svg,
                      double scale = 2.0);

/// The bytes of a PNG file of width * height * 3 bytes of colour, top row first. Throws RunError
/// when it cannot be made.
std::vector<std::uint8_t> rgb_png(int width, int height, std::span<const std::uint8_t> rgb);

}  // namespace screed
