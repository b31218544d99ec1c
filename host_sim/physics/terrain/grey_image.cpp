// PNG through libpng, BMP through stb_image. Both get the file as bytes in memory.
#include "host_sim/physics/terrain/grey_image.h"

#include <png.h>

#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"

// Only the BMP reader, private to this file: other libraries bring an stb_image of their own.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFile_bytes = std::uintmax_t{1} << 30;

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
  throw InputError(path.string() + ": " + what +
                   "; allowed: grey PNG (8 or 16 bit, opaque) or grey uncompressed BMP (8 or 24 "
                   "bit), 1 to " +
                   std::to_string(kLargestImageSide) + " samples a side");
}

void check_size(const fs::path& path, int64_t width, int64_t height) {
  if (width < 1 || height < 1 || width > kLargestImageSide || height > kLargestImageSide) {
    refuse(path, "image size " + std::to_string(width) + " x " + std::to_string(height));
  }
}

std::vector<uint8_t> read_bytes(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (error) refuse(path, error.message());
  if (fs::is_directory(status)) refuse(path, "is a folder, not an image");
  if (!fs::is_regular_file(status)) refuse(path, "is not a regular file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) refuse(path, error.message());
  if (size > kLargestFile_bytes) refuse(path, "file larger than 1 GiB");

  std::vector<uint8_t> bytes(size);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!file) refuse(path, "cannot be read");
  return bytes;
}

// ---- PNG -------------------------------------------------------------------------------------
// libpng reports errors by longjmp, which must not jump over destructors. So everything between a
// setjmp and the library's calls is plain data, owned by the caller of the function with the
// setjmp.

struct PngReader {
  std::span<const uint8_t> bytes;
  size_t position = 0;
  std::array<char, 128> error{};
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit PngReader(std::span<const uint8_t> source) : bytes(source) {}
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

[[noreturn]] void on_png_error(png_structp png, png_const_charp message) {
  auto& error = *static_cast<std::array<char, 128>*>(png_get_error_ptr(png));
  std::snprintf(error.data(), error.size(), "%s", message);
  png_longjmp(png, 1);
}

void on_png_warning(png_structp /*png*/, png_const_charp /*message*/) {}

void supply_png_bytes(png_structp png, png_bytep target, size_t count) {
  auto& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
  if (count > reader.bytes.size() - reader.position) png_error(png, "the file ends too early");
  std::memcpy(target, reader.bytes.data() + reader.position, count);
  reader.position += count;
}

bool read_png_header(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_read_fn(reader.png, &reader, supply_png_bytes);
  // A wrong check sum is an error in every chunk, not only in those that hold samples.
  png_set_crc_action(reader.png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
  png_read_info(reader.png, reader.info);
  return true;
}

// From then on a pixel is grey, grey and alpha, three colours, or those and alpha.
bool prepare_png_rows(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_set_expand(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool read_png_rows(PngReader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_image(reader.png, rows);
  png_read_end(reader.png, nullptr);
  return true;
}

constexpr std::array<uint8_t, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};

bool starts_like_png(std::span<const uint8_t> bytes) {
  return bytes.size() >= kPngSignature.size() &&
         std::memcmp(bytes.data(), kPngSignature.data(), kPngSignature.size()) == 0;
}

uint32_t big_endian32(const uint8_t* bytes) {
  return (uint32_t{bytes[0]} << 24) | (uint32_t{bytes[1]} << 16) | (uint32_t{bytes[2]} << 8) |
         bytes[3];
}

GreyImage read_png(const fs::path& path, std::span<const uint8_t> bytes) {
  // The header chunk comes first: its size is judged before libpng allocates for it.
  constexpr size_t kWidthOffset = 16;
  if (bytes.size() < kWidthOffset + 8) refuse(path, "truncated PNG");
  const int64_t width = big_endian32(bytes.data() + kWidthOffset);
  const int64_t height = big_endian32(bytes.data() + kWidthOffset + 4);
  check_size(path, width, height);

  PngReader reader(bytes);
  reader.png =
      png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader.error, on_png_error, on_png_warning);
  reader.info = reader.png != nullptr ? png_create_info_struct(reader.png) : nullptr;
  if (reader.info == nullptr) throw RunError(path.string() + ": out of memory for the PNG reader");
  if (!read_png_header(reader)) refuse(path, std::string("corrupt PNG: ") + reader.error.data());

  GreyImage image;
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  image.bit_depth = png_get_bit_depth(reader.png, reader.info) == 16 ? 16 : 8;
  image.max_value = image.bit_depth == 16 ? 65535 : 255;
  const size_t sample_bytes = image.bit_depth == 16 ? 2 : 1;
  if (!prepare_png_rows(reader)) refuse(path, std::string("corrupt PNG: ") + reader.error.data());
  const size_t channels = png_get_channels(reader.png, reader.info);
  const size_t row_bytes = static_cast<size_t>(width) * channels * sample_bytes;

  std::vector<uint8_t> raw(row_bytes * static_cast<size_t>(height));
  std::vector<png_bytep> rows(static_cast<size_t>(height));
  for (size_t row = 0; row < rows.size(); ++row) rows[row] = raw.data() + row * row_bytes;
  if (!read_png_rows(reader, rows.data())) {
    refuse(path, std::string("truncated or corrupt PNG: ") + reader.error.data());
  }

  const auto sample = [&](size_t i) -> uint16_t {
    return sample_bytes == 1 ? uint16_t{raw[i]}
                             : static_cast<uint16_t>((raw[2 * i] << 8) | raw[2 * i + 1]);
  };
  image.samples.resize(raw.size() / sample_bytes / channels);
  for (size_t i = 0; i < image.samples.size(); ++i) {
    const size_t pixel = i * channels;
    const auto refuse_pixel = [&](const char* what) {
      refuse(path, std::string("PNG with a ") + what + " pixel in column " +
                       std::to_string(i % static_cast<size_t>(width)) + ", row " +
                       std::to_string(i / static_cast<size_t>(width)));
    };
    image.samples[i] = sample(pixel);
    if (channels >= 3 &&
        (sample(pixel + 1) != sample(pixel) || sample(pixel + 2) != sample(pixel))) {
      refuse_pixel("coloured");
    }
    if (channels % 2 == 0 && sample(pixel + channels - 1) != image.max_value)
      refuse_pixel("transparent");
  }
  return image;
}

// ---- BMP -------------------------------------------------------------------------------------

uint32_t little_endian32(std::span<const uint8_t> bytes, size_t offset) {
  return uint32_t{bytes[offset]} | (uint32_t{bytes[offset + 1]} << 8) |
         (uint32_t{bytes[offset + 2]} << 16) | (uint32_t{bytes[offset + 3]} << 24);
}

// stb_image reads zeros past the end of a file and black for indices past the palette, so both are
// checked here. Offsets: BITMAPFILEHEADER (14 bytes) and BITMAPINFOHEADER of the Windows API.
void check_bmp(const fs::path& path, std::span<const uint8_t> bytes) {
  constexpr size_t kFileHeader = 14;
  constexpr size_t kSmallestInfoHeader = 40;
  if (bytes.size() < kFileHeader + kSmallestInfoHeader) refuse(path, "truncated BMP");
  const size_t pixels_begin = little_endian32(bytes, 10);
  const size_t info_header = little_endian32(bytes, 14);
  const int64_t width = static_cast<int32_t>(little_endian32(bytes, 18));
  const int64_t signed_height = static_cast<int32_t>(little_endian32(bytes, 22));  // < 0: top-down
  const int64_t height = signed_height < 0 ? -signed_height : signed_height;
  const size_t bits = little_endian32(bytes, 26) >> 16;
  const uint32_t compression = little_endian32(bytes, 30);
  const uint32_t colours_used = little_endian32(bytes, 46);

  if (info_header != 40 && info_header != 56 && info_header != 108 && info_header != 124) {
    refuse(path, "BMP with an unknown header of " + std::to_string(info_header) + " bytes");
  }
  check_size(path, width, height);
  if (bits != 8 && bits != 24) refuse(path, "BMP with " + std::to_string(bits) + " bits a pixel");
  if (compression != 0) refuse(path, "compressed BMP");
  const size_t colours = bits == 24 ? 0 : (colours_used == 0 ? 256 : colours_used);
  if (colours > 256 || pixels_begin < kFileHeader + info_header + 4 * colours) {
    refuse(path, "corrupt BMP: its palette overlaps its pixels");
  }
  const size_t row_bytes = (static_cast<size_t>(width) * bits + 31) / 32 * 4;
  if (bytes.size() < pixels_begin ||
      bytes.size() - pixels_begin < row_bytes * static_cast<size_t>(height)) {
    refuse(path, "truncated BMP");
  }
  if (bits == 24) return;
  for (size_t row = 0; row < static_cast<size_t>(height); ++row) {
    for (const uint8_t index :
         bytes.subspan(pixels_begin + row * row_bytes, static_cast<size_t>(width))) {
      if (index >= colours) refuse(path, "corrupt BMP: a pixel points past the palette");
    }
  }
}

GreyImage read_bmp(const fs::path& path, std::span<const uint8_t> bytes) {
  check_bmp(path, bytes);
  GreyImage image;
  int channels_in_file = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> rgb(
      stbi_load_from_memory(bytes.data(), static_cast<int>(bytes.size()), &image.width,
                            &image.height, &channels_in_file, 3),
      stbi_image_free);
  if (!rgb) refuse(path, std::string("corrupt BMP: ") + stbi_failure_reason());

  image.samples.resize(static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
  const stbi_uc* pixel = rgb.get();
  for (uint16_t& sample : image.samples) {
    if (pixel[0] != pixel[1] || pixel[1] != pixel[2]) refuse(path, "BMP with colours");
    sample = pixel[0];
    pixel += 3;
  }
  return image;
}

// ---- Writing ---------------------------------------------------------------------------------

struct PngWriter {
  std::array<char, 128> error{};
  png_structp png = nullptr;
  png_infop info = nullptr;

  PngWriter() = default;
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

void take_png_bytes(png_structp png, png_bytep source, size_t count) {
  auto& bytes = *static_cast<std::vector<uint8_t>*>(png_get_io_ptr(png));
  bytes.insert(bytes.end(), source, source + count);
}

void flush_png_bytes(png_structp /*png*/) {}

struct PngLayout {
  int width;
  int height;
  int bit_depth;
  int color_type;
};

bool write_png_rows(PngWriter& writer, std::vector<uint8_t>& bytes, const PngLayout& layout,
                    png_bytepp rows) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_set_write_fn(writer.png, &bytes, take_png_bytes, flush_png_bytes);
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(layout.width),
               static_cast<png_uint_32>(layout.height), layout.bit_depth, layout.color_type,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (layout.color_type == PNG_COLOR_TYPE_RGB) {
    // libpng tries five filters on each row and looks long for repetitions: on pictures of terrain
    // seven times the work for a file that is a sixth smaller.
    png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
    png_set_compression_level(writer.png, 1);
  }
  png_write_info(writer.png, writer.info);
  png_write_image(writer.png, rows);
  png_write_end(writer.png, nullptr);
  return true;
}

/// The bytes of a file. `raw` holds the rows as PNG stores them (16-bit samples with the high byte
/// first). Throws RunError.
std::vector<uint8_t> png_bytes(const PngLayout& layout, std::span<const uint8_t> raw) {
  const size_t channels = layout.color_type == PNG_COLOR_TYPE_RGB ? 3 : 1;
  const size_t row_bytes =
      static_cast<size_t>(layout.width) * channels * static_cast<size_t>(layout.bit_depth / 8);
  if (layout.width < 1 || layout.height < 1 ||
      raw.size() != row_bytes * static_cast<size_t>(layout.height)) {
    throw std::invalid_argument("png_bytes: samples do not fit the image size");
  }
  std::vector<png_bytep> rows(static_cast<size_t>(layout.height));
  for (size_t row = 0; row < rows.size(); ++row) {
    rows[row] = const_cast<png_bytep>(raw.data() + row * row_bytes);  // libpng does not write there
  }

  std::vector<uint8_t> bytes;
  PngWriter writer;
  writer.png =
      png_create_write_struct(PNG_LIBPNG_VER_STRING, &writer.error, on_png_error, on_png_warning);
  writer.info = writer.png != nullptr ? png_create_info_struct(writer.png) : nullptr;
  if (writer.info == nullptr) throw RunError("out of memory for the PNG writer");
  if (!write_png_rows(writer, bytes, layout, rows.data())) {
    throw RunError(std::string("a picture cannot be made: ") + writer.error.data());
  }
  return bytes;
}

void write_bytes(const fs::path& path, std::span<const uint8_t> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace

GreyImage read_grey_image(const fs::path& path) {
  const std::vector<uint8_t> bytes = read_bytes(path);
  if (starts_like_png(bytes)) return read_png(path, bytes);
  if (bytes.size() >= 2 && bytes[0] == 'B' && bytes[1] == 'M') return read_bmp(path, bytes);
  refuse(path, bytes.empty() ? "empty file" : "neither a PNG nor a BMP file");
}

void write_grey16_png(const fs::path& path, int width, int height,
                      std::span<const uint16_t> samples) {
  std::vector<uint8_t> raw(samples.size() * 2);
  for (size_t i = 0; i < samples.size(); ++i) {
    raw[2 * i] = static_cast<uint8_t>(samples[i] >> 8);
    raw[2 * i + 1] = static_cast<uint8_t>(samples[i] & 0xFF);
  }
  write_bytes(path, png_bytes({width, height, 16, PNG_COLOR_TYPE_GRAY}, raw));
}

void write_grey8_bmp(const fs::path& path, int width, int height,
                     std::span<const uint16_t> samples) {
  if (width < 1 || height < 1 ||
      samples.size() != static_cast<size_t>(width) * static_cast<size_t>(height)) {
    throw std::invalid_argument("write_grey8_bmp: samples do not fit the image size");
  }
  constexpr uint32_t kPaletteBytes = 4 * 256;
  constexpr uint32_t kHeaderBytes = 14 + 40;
  const size_t row_bytes = (static_cast<size_t>(width) + 3) / 4 * 4;
  const size_t image_bytes = row_bytes * static_cast<size_t>(height);
  std::vector<uint8_t> bytes = {'B', 'M'};
  bytes.reserve(kHeaderBytes + kPaletteBytes + image_bytes);
  const auto put = [&](uint32_t value, int count) {
    for (int i = 0; i < count; ++i) bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
  };
  put(kHeaderBytes + kPaletteBytes + static_cast<uint32_t>(image_bytes), 4);
  put(0, 4);
  put(kHeaderBytes + kPaletteBytes, 4);
  put(40, 4);  // BITMAPINFOHEADER
  put(static_cast<uint32_t>(width), 4);
  put(static_cast<uint32_t>(height), 4);  // positive: the bottom row comes first
  put(1, 2);
  put(8, 2);
  put(0, 4);  // not compressed
  put(static_cast<uint32_t>(image_bytes), 4);
  put(2835, 4);  // 72 dots an inch
  put(2835, 4);
  put(256, 4);
  put(0, 4);
  for (uint32_t grey = 0; grey < 256; ++grey) put(grey * 0x010101U, 4);
  for (int row = height - 1; row >= 0; --row) {
    const auto line = samples.subspan(static_cast<size_t>(row) * static_cast<size_t>(width),
                                      static_cast<size_t>(width));
    for (const uint16_t sample : line) {
      bytes.push_back(static_cast<uint8_t>((sample * 255U + 32767U) / 65535U));
    }
    bytes.insert(bytes.end(), row_bytes - static_cast<size_t>(width), 0);
  }
  write_bytes(path, bytes);
}

std::vector<uint8_t> rgb_png(int width, int height, std::span<const uint8_t> rgb) {
  return png_bytes({width, height, 8, PNG_COLOR_TYPE_RGB}, rgb);
}

void write_rgb_png(const fs::path& path, int width, int height, std::span<const uint8_t> rgb) {
  write_bytes(path, rgb_png(width, height, rgb));
}

}  // namespace screed
