// Grey-scale image files: height maps in (PNG, BMP), pictures out (PNG).
// Knows files and samples only: no metres, no terrain.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace screed {

/// The longest side of an image that is read, in samples.
inline constexpr int kLargestImageSide = 16384;

/// A grey-scale image with the samples exactly as the file stores them (no gamma conversion).
struct GreyImage {
  int width = 0;                  ///< samples a row, 1..kLargestImageSide
  int height = 0;                 ///< rows, 1..kLargestImageSide
  int bit_depth = 8;              ///< 8 or 16
  uint16_t max_value = 255;       ///< sample value of full white: 255 or 65535
  std::vector<uint16_t> samples;  ///< width * height values, row by row, row 0 = top
};

/// Reads a grey PNG (8 or 16 bit; 1, 2 and 4 bit are widened to 8) or a grey, uncompressed BMP
/// (8 bit with a palette of greys, or 24 bit). Channels or a palette of colours are as good when
/// red = green = blue everywhere, and alpha when all is opaque.
/// Throws InputError, one line with the path and what is allowed, for everything else: missing or
/// unreadable file, folder, other format, a coloured or transparent pixel, truncated or corrupt
/// data, absurd size.
GreyImage read_grey_image(const std::filesystem::path& path);

/// Writes a 16-bit grey PNG from width * height samples, row 0 = top.
/// The file appears complete or not at all: it is written beside `path` and then renamed. Throws
/// RunError, one line with the path and the reason, when it cannot be written (folder missing,
/// disk full, `path` is no regular file); a file that was there before then stays as it was.
void write_grey16_png(const std::filesystem::path& path, int width, int height,
                      std::span<const uint16_t> samples);

/// Writes an 8-bit grey BMP with a palette, as the thesis' height maps are: the upper 8 bits of
/// width * height 16-bit samples, rounded, row 0 = top. Otherwise as above.
void write_grey8_bmp(const std::filesystem::path& path, int width, int height,
                     std::span<const uint16_t> samples);

/// The bytes of an 8-bit RGB PNG of width * height * 3 bytes, row 0 = top. Throws RunError when
/// they cannot be made.
std::vector<uint8_t> rgb_png(int width, int height, std::span<const uint8_t> rgb);

/// The same as a file. Otherwise as above.
void write_rgb_png(const std::filesystem::path& path, int width, int height,
                   std::span<const uint8_t> rgb);

}  // namespace screed
