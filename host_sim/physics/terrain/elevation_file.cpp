// Text and arrays by hand, TIFF through libtiff with the few tags of GeoTIFF (OGC 19-008r4) that
// heights need.
#include "host_sim/physics/terrain/elevation_file.h"

#include <tiffio.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/grey_image.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "arrays are taken as they stand on disk");

[[noreturn]] void reject(const fs::path& path, const std::string& what) {
  throw InputError(path.string() + ": " + what);
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string extension_of(const fs::path& path) {
  return lower_case(path.extension().string());
}

void set_size(const fs::path& path, double width, double height, Elevation& elevation) {
  if (!(width >= 1 && height >= 1 && width <= kLargestImageSide && height <= kLargestImageSide)) {
    std::ostringstream text;
    text << "has " << width << " x " << height << " heights; allowed: 1 to " << kLargestImageSide
         << " a side";
    reject(path, text.str());
  }
  elevation.width = static_cast<int>(width);
  elevation.height = static_cast<int>(height);
  elevation.heights_m.resize(static_cast<size_t>(elevation.width) *
                             static_cast<size_t>(elevation.height));
}

/// no_data: the file's mark for a cell without a height.
void check_heights(const fs::path& path, const Elevation& elevation,
                   std::optional<double> no_data) {
  const auto is_missing = [&](double height) {
    return !std::isfinite(height) || height == no_data;
  };
  const auto missing =
      std::count_if(elevation.heights_m.begin(), elevation.heights_m.end(), is_missing);
  if (missing == 0) return;
  reject(path, std::to_string(missing) + " of " + std::to_string(elevation.heights_m.size()) +
                   " cells have no height; fill them first (gdal_fillnodata.py does)");
}

// ---- Esri ASCII grid ----

std::optional<double> number_of(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

Elevation read_asc(const fs::path& path, std::ifstream& file) {
  Elevation elevation;
  double width = 0.0;
  double height = 0.0;
  std::optional<double> no_data;
  std::string word;
  // "nan" may be the first height.
  while (file >> word && std::isalpha(static_cast<unsigned char>(word[0])) != 0 &&
         !number_of(word).has_value()) {
    const std::string key = lower_case(word);
    file >> word;
    const std::optional<double> value = number_of(word);
    if (!value.has_value()) {
      std::string what = key;
      reject(path, what.append(" is '").append(word).append("', a number is needed"));
    }
    if (key == "ncols") width = *value;
    if (key == "nrows") height = *value;
    if (key == "cellsize") elevation.cell_m = *value;
    if (key == "nodata_value") no_data = value;
  }
  if (width == 0.0 || height == 0.0 || !(elevation.cell_m > 0.0)) {
    reject(path, "is no Esri ASCII grid: ncols, nrows and cellsize, each > 0, come first");
  }
  set_size(path, width, height, elevation);
  for (size_t i = 0; i < elevation.heights_m.size(); ++i) {
    const std::optional<double> value = file ? number_of(word) : std::nullopt;
    if (!value.has_value()) {
      reject(path, "row " + std::to_string(i / static_cast<size_t>(width) + 1) + ", column " +
                       std::to_string(i % static_cast<size_t>(width) + 1) +
                       (file ? ": '" + word + "' is no height" : ": the file ends too early"));
    }
    elevation.heights_m[i] = *value;
    file >> word;
  }
  check_heights(path, elevation, no_data);
  return elevation;
}

// ---- NumPy array (numpy.lib.format) ----

/// What stands behind 'NAME': in the header's dictionary, up to the next comma outside brackets.
std::string npy_entry(const std::string& header, const std::string& name) {
  const size_t at = header.find("'" + name + "':");
  if (at == std::string::npos) return "";
  const size_t begin = header.find_first_not_of(' ', at + name.size() + 3);
  const size_t end = begin == std::string::npos || header[begin] == '('
                         ? header.find(')', at)
                         : header.find_first_of(",}", begin);
  return end == std::string::npos ? "" : header.substr(begin, end - begin);
}

template <typename Number>
void read_numbers(std::istream& file, std::vector<double>& heights_m) {
  std::vector<Number> numbers(heights_m.size());
  file.read(reinterpret_cast<char*>(numbers.data()),
            static_cast<std::streamsize>(numbers.size() * sizeof(Number)));
  for (size_t i = 0; i < numbers.size(); ++i) heights_m[i] = static_cast<double>(numbers[i]);
}

Elevation read_npy(const fs::path& path, std::ifstream& file) {
  constexpr std::string_view kMagic = "\x93NUMPY";
  char begin[8] = {};
  file.read(begin, sizeof begin);
  if (!file || std::string_view(begin, kMagic.size()) != kMagic) reject(path, "is no NumPy array");
  const bool is_first_version = begin[6] == 1;
  uint32_t size = 0;
  file.read(reinterpret_cast<char*>(&size), is_first_version ? 2 : 4);
  if (!file || size > 65536) reject(path, "the header of the NumPy array is damaged");
  std::string header(size, ' ');
  file.read(header.data(), static_cast<std::streamsize>(size));
  Elevation elevation;
  double rows = 0.0;
  double columns = 0.0;
  char more = '\0';
  if (std::sscanf(npy_entry(header, "shape").c_str(), "(%lf, %lf%c", &rows, &columns, &more) != 2) {
    reject(path, "needs two dimensions, rows and columns; its shape is " +
                     npy_entry(header, "shape") + ")");
  }
  if (npy_entry(header, "fortran_order") != "False") {
    reject(path, "is in Fortran order; numpy.ascontiguousarray() makes it C order");
  }
  set_size(path, columns, rows, elevation);
  const std::string type = npy_entry(header, "descr");
  if (type == "'<f4'") {
    read_numbers<float>(file, elevation.heights_m);
  } else if (type == "'<f8'") {
    read_numbers<double>(file, elevation.heights_m);
  } else if (type == "'<i2'") {
    read_numbers<int16_t>(file, elevation.heights_m);
  } else if (type == "'<i4'") {
    read_numbers<int32_t>(file, elevation.heights_m);
  } else if (type == "'<i8'") {
    read_numbers<int64_t>(file, elevation.heights_m);
  } else {
    reject(path, "holds numbers of type " + type +
                     "; allowed: '<f4', '<f8', '<i2', '<i4', '<i8' (little endian)");
  }
  if (!file) reject(path, "the file ends too early");
  check_heights(path, elevation, std::nullopt);
  return elevation;
}

// ---- GeoTIFF ----

constexpr uint32_t kPixelScaleTag = 33550;
constexpr uint32_t kGeoKeysTag = 34735;
constexpr uint32_t kNoDataTag = 42113;  // of GDAL: a number as text

thread_local std::string tiff_error;

void keep_tiff_error(const char* /*module*/, const char* format, va_list values) {
  char text[200];
  std::vsnprintf(text, sizeof text, format, values);
  if (tiff_error.empty()) tiff_error = text;
}

/// Makes the tags known to libtiff, which names unknown ones on standard error.
void know_tags(TIFF* tiff) {
  static char names[3][16] = {"GeoPixelScale", "GeoKeyDirectory", "GDALNoData"};
  static const TIFFFieldInfo kTags[] = {
      {kPixelScaleTag, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, names[0]},
      {kGeoKeysTag, -1, -1, TIFF_SHORT, FIELD_CUSTOM, 1, 1, names[1]},
      {kNoDataTag, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, names[2]}};
  TIFFMergeFieldInfo(tiff, kTags, 3);
}

/// Whether the file says that its cells are in degrees: GTModelTypeGeoKey (1024) is geographic.
bool is_geographic(TIFF* tiff) {
  uint16_t count = 0;
  const uint16_t* keys = nullptr;
  if (TIFFGetField(tiff, kGeoKeysTag, &count, &keys) != 1) return false;
  for (uint16_t i = 4; i + 3 < count; i = static_cast<uint16_t>(i + 4)) {
    if (keys[i] == 1024) return keys[i + 3] == 2;
  }
  return false;
}

/// Puts a block of the picture's numbers into their place; what sticks out over its edges is left.
template <typename Number>
void put_block(const std::vector<uint8_t>& block, int x0, int y0, int width, int height,
               Elevation& elevation) {
  for (int y = 0; y < height && y0 + y < elevation.height; ++y) {
    for (int x = 0; x < width && x0 + x < elevation.width; ++x) {
      Number number{};
      std::memcpy(&number,
                  block.data() + (static_cast<size_t>(y) * static_cast<size_t>(width) +
                                  static_cast<size_t>(x)) *
                                     sizeof number,
                  sizeof number);
      elevation.heights_m[static_cast<size_t>(y0 + y) * static_cast<size_t>(elevation.width) +
                          static_cast<size_t>(x0 + x)] = static_cast<double>(number);
    }
  }
}

using PutBlock = void (*)(const std::vector<uint8_t>&, int, int, int, int, Elevation&);

PutBlock put_block_of(uint16_t format, uint16_t bits) {
  const bool real = format == SAMPLEFORMAT_IEEEFP;
  const bool with_sign = format == SAMPLEFORMAT_INT;
  if (real) return bits == 32 ? put_block<float> : bits == 64 ? put_block<double> : nullptr;
  if (bits == 8) return with_sign ? put_block<int8_t> : put_block<uint8_t>;
  if (bits == 16) return with_sign ? put_block<int16_t> : put_block<uint16_t>;
  if (bits == 32) return with_sign ? put_block<int32_t> : put_block<uint32_t>;
  return nullptr;
}

/// All strips or tiles.
void read_blocks(const fs::path& path, TIFF* tiff, PutBlock put, Elevation& elevation) {
  const bool tiled = TIFFIsTiled(tiff) != 0;
  uint32_t width = static_cast<uint32_t>(elevation.width);
  uint32_t height = static_cast<uint32_t>(elevation.height);
  if (tiled) {
    TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_TILELENGTH, &height);
  } else {
    uint32_t rows = 0;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &rows);
    height = std::min(height, rows);
  }
  const tmsize_t bytes = tiled ? TIFFTileSize(tiff) : TIFFStripSize(tiff);
  constexpr tmsize_t kLargestBlock_bytes = tmsize_t{1} << 30;
  if (bytes < 1 || bytes > kLargestBlock_bytes || width < 1 || height < 1)
    reject(path, "its blocks are damaged");
  std::vector<uint8_t> block(static_cast<size_t>(bytes));
  for (uint32_t y = 0; y < static_cast<uint32_t>(elevation.height); y += height) {
    for (uint32_t x = 0; x < static_cast<uint32_t>(elevation.width); x += width) {
      const tmsize_t got =
          tiled ? TIFFReadTile(tiff, block.data(), x, y, 0, 0)
                : TIFFReadEncodedStrip(tiff, TIFFComputeStrip(tiff, y, 0), block.data(), bytes);
      if (got < 0) reject(path, "cannot be read: " + tiff_error);
      put(block, static_cast<int>(x), static_cast<int>(y), static_cast<int>(width),
          static_cast<int>(height), elevation);
    }
  }
}

Elevation read_tiff(const fs::path& path) {
  TIFFSetWarningHandler(nullptr);
  TIFFSetErrorHandler(keep_tiff_error);
  TIFFSetTagExtender(know_tags);
  tiff_error.clear();
  const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(TIFFOpen(path.c_str(), "r"), TIFFClose);
  if (!tiff) reject(path, "is no TIFF: " + tiff_error);
  uint32_t width = 0;
  uint32_t height = 0;
  uint16_t bands = 1;
  uint16_t bits = 1;
  uint16_t format = SAMPLEFORMAT_UINT;
  TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &width);
  TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &height);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, &bands);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLEFORMAT, &format);
  if (bands != 1) reject(path, "has " + std::to_string(bands) + " bands; heights are one");
  const PutBlock put = put_block_of(format, bits);
  if (put == nullptr) {
    reject(path, "holds numbers of " + std::to_string(bits) +
                     " bits that are no heights; allowed: floats of 32 or 64, integers of 8, 16 or "
                     "32");
  }
  if (is_geographic(tiff.get())) {
    reject(path, "its cells are in degrees; gdalwarp -t_srs EPSG:... gives it metres (UTM, say)");
  }
  Elevation elevation;
  set_size(path, width, height, elevation);
  uint16_t count = 0;
  const double* scale = nullptr;
  if (TIFFGetField(tiff.get(), kPixelScaleTag, &count, &scale) == 1 && count >= 2) {
    if (!(scale[0] > 0.0) || std::abs(scale[0] - scale[1]) > 1e-6 * scale[0])
      reject(path, "its cells are not square");
    elevation.cell_m = scale[0];
  }
  read_blocks(path, tiff.get(), put, elevation);
  const char* no_data = nullptr;
  std::optional<double> mark;
  if (TIFFGetField(tiff.get(), kNoDataTag, &no_data) == 1) mark = number_of(no_data);
  // Marks are rounded as the heights are.
  if (mark.has_value() && format == SAMPLEFORMAT_IEEEFP && bits == 32)
    mark = static_cast<double>(static_cast<float>(*mark));
  check_heights(path, elevation, mark);
  return elevation;
}

}  // namespace

bool is_elevation_file(const fs::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".asc" || extension == ".npy" || extension == ".tif" || extension == ".tiff";
}

Elevation read_elevation(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) reject(path, "no such file, or not a file");
  const std::string extension = extension_of(path);
  if (extension == ".tif" || extension == ".tiff") return read_tiff(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) reject(path, "cannot be read");
  return extension == ".asc" ? read_asc(path, file) : read_npy(path, file);
}

}  // namespace screed
