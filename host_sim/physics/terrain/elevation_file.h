// Elevation models, from files of heights in metres: an Esri ASCII grid (.asc), a NumPy array
// (.npy), a GeoTIFF (.tif, .tiff). Knows files and numbers only: no terrain.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace screed {

struct Elevation {
  int width = 0;                  ///< heights a row, 1..kLargestImageSide
  int height = 0;                 ///< rows
  std::vector<double> heights_m;  ///< width * height finite values, row by row, row 0 = north
  std::optional<double> cell_m;   ///< between two heights, where the file says so; > 0
};

/// Whether the file's name ends as those of elevation models do.
bool is_elevation_file(const std::filesystem::path& path);

/// Reads such a file.
///   .asc   ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize and perhaps
///          NODATA_value, each before its number, then the rows from the north
///   .npy   two dimensions of floating-point or integer numbers in C order, the first from north to
///          south; no cell size
///   .tif   one band of floating-point or integer numbers, square cells in a projected system
/// Throws InputError, one line with the path and what is wrong: also for cells without a height
/// (NaN or the file's mark for them), for degrees in place of metres and for more than
/// kLargestImageSide a side.
Elevation read_elevation(const std::filesystem::path& path);

}  // namespace screed
