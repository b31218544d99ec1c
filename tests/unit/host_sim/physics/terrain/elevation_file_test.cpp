// Elevation models, written by GDAL and NumPy (tests/data/elevation).
#include "host_sim/physics/terrain/elevation_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/height_field.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

const std::vector<double> kRamp = {12.0, 12.25, 12.5, 12.75, 11.0, 11.25,
                                   11.5, 11.75, 10.0, 10.25, 10.5, 10.875};
const std::vector<double> kWhole = {12, 12, 12, 12, 11, 11, 11, 11, 10, 10, 10, 10};

std::string data(const char* name) {
  return std::string("tests/data/elevation/") + name;
}

std::string error_of(const std::filesystem::path& path) {
  try {
    read_elevation(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

void expect_elevation(const char* name, const std::vector<double>& heights_m,
                      std::optional<double> cell_m) {
  SCOPED_TRACE(name);
  const Elevation elevation = read_elevation(data(name));
  EXPECT_EQ(elevation.width, 4);
  EXPECT_EQ(elevation.height, 3);
  EXPECT_EQ(elevation.heights_m, heights_m);
  EXPECT_EQ(elevation.cell_m, cell_m);
}

TEST(ElevationFile, ReadsGridsArraysAndGeoTiffs) {
  expect_elevation("ramp.asc", kRamp, 0.5);
  expect_elevation("ramp_strips.tif", kRamp, 0.5);
  expect_elevation("ramp_tiles.tif", kRamp, 0.5);
  expect_elevation("ramp_f4.npy", kRamp, std::nullopt);
  expect_elevation("ramp_f8.npy", kRamp, std::nullopt);
  expect_elevation("whole.npy", kWhole, std::nullopt);
  EXPECT_EQ(read_elevation(data("whole.tif")).heights_m,
            (std::vector<double>{12, 12, 13, 13, 11, 11, 12, 12, 10, 10, 11, 11}));  // GDAL rounds
  EXPECT_TRUE(is_elevation_file("DEM.TIFF"));
  EXPECT_FALSE(is_elevation_file("map.png"));
}

TEST(ElevationFile, RefusesWhatHasNoHeightsInMetres) {
  EXPECT_EQ(error_of(data("hole.tif")),
            data("hole.tif") +
                ": 1 of 12 cells have no height; fill them first (gdal_fillnodata.py does)");
  EXPECT_NE(error_of(data("degrees.tif")).find("its cells are in degrees"), std::string::npos);
  EXPECT_NE(error_of(data("fortran.npy")).find("Fortran order"), std::string::npos);
  EXPECT_NE(error_of(data("cube.npy")).find("its shape is (2, 2, 2)"), std::string::npos);
  EXPECT_NE(error_of(data("big_endian.npy")).find("numbers of type '>f4'"), std::string::npos);
  EXPECT_EQ(error_of("gone.asc"), "gone.asc: no such file, or not a file");
}

TEST(ElevationFile, WrongTextIsNamedWithItsPlace) {
  const TempFolder folder;
  const std::filesystem::path file = folder.path() / "grid.asc";
  const auto error = [&](const std::string& text) {
    write_text(file, text);
    const std::string message = error_of(file);
    return message.starts_with(file.string() + ": ") ? message.substr(file.string().size() + 2)
                                                     : message;
  };
  const std::string head = "NCOLS 2\nNROWS 2\ncellsize 0.1\n";
  EXPECT_EQ(error(head + "1 2\n3 4\n"), "no error");
  EXPECT_EQ(error(head + "1 2\n3"), "row 2, column 2: the file ends too early");
  EXPECT_EQ(error(head + "1 2\n3,5 4\n"), "row 2, column 1: '3,5' is no height");
  EXPECT_EQ(error(head + "3,5 2\n3 4\n"), "row 1, column 1: '3,5' is no height");
  for (const char* heights : {"1 nan\n3 4\n", "nan 2\n3 4\n"}) {
    EXPECT_EQ(error(head + heights),
              "1 of 4 cells have no height; fill them first (gdal_fillnodata.py does)");
  }
  EXPECT_EQ(error("ncols 2\nnrows two\n"), "nrows is 'two', a number is needed");
  EXPECT_EQ(error("1 2\n3 4\n"),
            "is no Esri ASCII grid: ncols, nrows and cellsize, each > 0, come first");
  EXPECT_EQ(error("ncols 20000\nnrows 2\ncellsize 1\n"),
            "has 20000 x 2 heights; allowed: 1 to 16384 a side");
}

// Whatever is cut off, no file is read beyond its end.
TEST(ElevationFile, EveryTruncationIsRefused) {
  const TempFolder folder;
  for (const char* name : {"ramp_strips.tif", "ramp_tiles.tif", "ramp_f4.npy"}) {
    const std::string text = read_text(data(name));
    const std::filesystem::path file = folder.path() / name;
    // The end of a TIFF by GDAL is a tag's or a tile's; of an array a number's.
    for (std::size_t length = 0; length + 1 < text.size(); length += 7) {
      write_text(file, text.substr(0, length));
      const std::string error = error_of(file);
      EXPECT_NE(error, "no error") << name << " " << length;
    }
  }
}

TEST(ElevationFile, BecomesATerrainWithItsLowestAtZero) {
  const Elevation elevation = read_elevation(data("ramp.asc"));
  HeightFieldOptions options;
  options.size_m = 1.5;
  const HeightField field =
      HeightField::from_heights(elevation.width, elevation.height, elevation.heights_m, options);
  EXPECT_DOUBLE_EQ(field.spacing_m(), 0.5);
  EXPECT_NEAR(field.node(0, 0) * kHeightUnit_m, 0.0, kHeightUnit_m);  // south-west
  EXPECT_NEAR(field.node(3, 0) * kHeightUnit_m, 0.875, kHeightUnit_m);
  EXPECT_NEAR(field.node(0, 2) * kHeightUnit_m, 2.0, kHeightUnit_m);  // north-west
  EXPECT_THROW(HeightField::from_heights(2, 2, {0.0, 0.0, 0.0, 128.0}, options), InputError);
}

}  // namespace
}  // namespace screed
