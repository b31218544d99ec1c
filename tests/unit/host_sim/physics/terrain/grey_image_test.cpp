// Reading height maps made by another program, refusing everything else, writing atomically.
#include "host_sim/physics/terrain/grey_image.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tests/file_size_limit.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

fs::path image_path(const std::string& name) {
  return fs::path("tests/data/images") / name;
}

const std::vector<uint16_t> kGrey8 = {0, 1, 2, 3, 64, 128, 192, 254, 255, 10, 20, 30};
const std::vector<uint16_t> kGrey16 = {0,     1,     255,   256,  4660,  32768,
                                       43981, 65534, 65535, 1000, 20000, 30000};

class GreyImageTest : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  size_t files_in_folder() const {
    return static_cast<size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  TempFolder temporary_;
  fs::path folder_ = temporary_.path();
};

void expect_image(const std::string& name, int width, int height, int bit_depth,
                  const std::vector<uint16_t>& samples) {
  SCOPED_TRACE(name);
  const GreyImage image = read_grey_image(image_path(name));
  EXPECT_EQ(image.width, width);
  EXPECT_EQ(image.height, height);
  EXPECT_EQ(image.bit_depth, bit_depth);
  EXPECT_EQ(image.max_value, bit_depth == 16 ? 65535 : 255);
  EXPECT_EQ(image.samples, samples);
}

/// The message names the path, says what is wrong (`reason`) and what is allowed, in one line.
void expect_refused(const fs::path& path, const std::string& reason) {
  SCOPED_TRACE(path);
  try {
    read_grey_image(path);
    ADD_FAILURE() << "was accepted";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind(path.string() + ": ", 0), 0U) << message;
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_NE(message.find("allowed: grey PNG"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST_F(GreyImageTest, ReadsGreyPng) {
  expect_image("grey8.png", 4, 3, 8, kGrey8);
  expect_image("grey16.png", 4, 3, 16, kGrey16);
  expect_image("grey16_interlaced.png", 4, 3, 16, kGrey16);
  expect_image("grey2.png", 4, 1, 8, {0, 85, 170, 255});
}

TEST_F(GreyImageTest, ReadsGreysHoweverTheyAreStored) {
  for (const char* name : {"rgb.png", "palette.png", "rgba.png", "grey_opaque.png"})
    expect_image(name, 4, 3, 8, kGrey8);
}

TEST_F(GreyImageTest, IgnoresGamma) {
  expect_image("grey16_gamma.png", 4, 3, 16, kGrey16);
}

TEST_F(GreyImageTest, ReadsGreyBmp) {
  expect_image("grey24.bmp", 4, 3, 8, kGrey8);
  expect_image("grey24_v5.bmp", 4, 3, 8, kGrey8);
  expect_image("grey8.bmp", 6, 4, 8, {0,   11,  22,  33,  44,  55,  66,  77,  88,  99,  110, 121,
                                      132, 143, 154, 165, 176, 187, 198, 209, 220, 231, 242, 255});
}

TEST_F(GreyImageTest, ReadsBmpStoredFromTheTop) {
  std::string bytes = read_text(image_path("grey24.bmp"));
  bytes.replace(22, 4, "\xFD\xFF\xFF\xFF", 4);  // height -3
  const GreyImage image = read_grey_image(write("top_down.bmp", bytes));
  EXPECT_EQ(image.height, 3);
  EXPECT_EQ(image.samples, (std::vector<uint16_t>{255, 10, 20, 30, 64, 128, 192, 254, 0, 1, 2, 3}));
}

TEST_F(GreyImageTest, RefusesColourAndAlpha) {
  expect_refused(image_path("colour.png"), "coloured pixel in column 0, row 0");
  expect_refused(image_path("grey_alpha.png"), "transparent pixel in column 0, row 0");
  expect_refused(image_path("grey_transparent.png"), "transparent pixel in column 1, row 2");
  expect_refused(image_path("colour8.bmp"), "BMP with colours");
  expect_refused(image_path("colour24.bmp"), "BMP with colours");
}

TEST_F(GreyImageTest, RefusesOtherKindsOfBmp) {
  expect_refused(image_path("grey1.bmp"), "1 bits a pixel");
  expect_refused(image_path("grey8_rle.bmp"), ": compressed BMP");
  std::string bytes = read_text(image_path("grey24.bmp"));
  bytes[14] = 12;  // the header of OS/2
  expect_refused(write("os2.bmp", bytes), "unknown header of 12 bytes");
}

TEST_F(GreyImageTest, RefusesWhatIsNoImageFile) {
  expect_refused(folder_ / "missing.png", "No such file");
  expect_refused(folder_, "is a folder");
  expect_refused("/dev/zero", "not a regular file");  // only read: nothing can happen to it
  expect_refused(write("empty.png", ""), "empty file");
  expect_refused(write("text.png", "P2\n1 1\n255\n7\n"), "neither a PNG nor a BMP");
}

TEST_F(GreyImageTest, RefusesEveryTruncation) {
  for (const char* name : {"grey16.png", "grey16_interlaced.png", "grey8.bmp", "grey24.bmp"}) {
    const std::string bytes = read_text(image_path(name));
    for (size_t length = 0; length < bytes.size(); ++length) {
      SCOPED_TRACE(length);
      EXPECT_THROW(read_grey_image(write(name, bytes.substr(0, length))), InputError) << name;
    }
  }
}

TEST_F(GreyImageTest, RefusesEveryFlippedByteOfAPng) {
  for (const char* name : {"grey16.png", "grey16_gamma.png"}) {  // with an optional chunk, too
    const std::string bytes = read_text(image_path(name));
    for (size_t place = 0; place < bytes.size(); ++place) {
      std::string corrupt = bytes;
      corrupt[place] = static_cast<char>(corrupt[place] ^ 0x10);
      SCOPED_TRACE(place);
      EXPECT_THROW(read_grey_image(write("corrupt.png", corrupt)), InputError) << name;
    }
  }
}

TEST_F(GreyImageTest, NamesTheWrongCheckSum) {
  std::string bytes = read_text(image_path("grey16.png"));
  constexpr size_t kDataCheckSum = 77;
  bytes[kDataCheckSum] = static_cast<char>(bytes[kDataCheckSum] ^ 1);
  expect_refused(write("crc.png", bytes), "CRC error");
}

TEST_F(GreyImageTest, RefusesAbsurdSizes) {
  const std::string png = read_text(image_path("grey16.png"));
  const auto png_with_width = [&](const std::string& width) {
    return write("size.png", std::string(png).replace(16, 4, width));
  };
  expect_refused(png_with_width(std::string(4, '\0')), "image size 0 x 3");
  expect_refused(png_with_width(std::string("\0\0\x40\x01", 4)), "image size 16385 x 3");
  const std::string bmp = read_text(image_path("grey24.bmp"));
  const auto bmp_with_height = [&](const std::string& height) {
    return write("size.bmp", std::string(bmp).replace(22, 4, height));
  };
  expect_refused(bmp_with_height(std::string(4, '\0')), "image size 4 x 0");
  expect_refused(bmp_with_height(std::string("\0\0\0\x80", 4)), "image size 4 x 2147483648");
}

TEST_F(GreyImageTest, RefusesBmpWithBrokenPalette) {
  const std::string bytes = read_text(image_path("grey8.bmp"));
  std::string small = bytes;
  small.replace(46, 4, std::string("\x0A\0\0\0", 4));  // 10 colours, pixels up to 255
  expect_refused(write("small_palette.bmp", small), "points past the palette");
  std::string large = bytes;
  large.replace(46, 4, std::string("\0\0\1\0", 4));
  expect_refused(write("large_palette.bmp", large), "palette overlaps");
}

TEST_F(GreyImageTest, WritesWhatItReads) {
  const fs::path path = folder_ / "grey.png";
  write_grey16_png(path, 4, 3, kGrey16);
  const GreyImage image = read_grey_image(path);
  EXPECT_EQ(image.width, 4);
  EXPECT_EQ(image.bit_depth, 16);
  EXPECT_EQ(image.samples, kGrey16);
  write_grey16_png(path, 2, 1, std::vector<uint16_t>{7, 8});  // replaces the file
  EXPECT_EQ(read_grey_image(path).samples, (std::vector<uint16_t>{7, 8}));
  EXPECT_EQ(files_in_folder(), 1U);
}

TEST_F(GreyImageTest, WritesRgb) {
  const fs::path path = folder_ / "rgb.png";
  write_rgb_png(path, 2, 1, std::vector<uint8_t>{1, 2, 3, 4, 5, 6});
  expect_refused(path, "coloured pixel in column 0, row 0");
  EXPECT_THROW(write_rgb_png(path, 2, 2, std::vector<uint8_t>(6)), std::invalid_argument);
}

void expect_unwritable(const fs::path& path) {
  try {
    write_grey16_png(path, 4, 3, kGrey16);
    ADD_FAILURE() << "was written";
  } catch (const RunError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind(path.string() + ": cannot be written: ", 0), 0U) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST_F(GreyImageTest, SaysWhatCannotBeWritten) {
  expect_unwritable(write("file", "x") / "below_a_file.png");
  expect_unwritable(folder_ / "missing" / "a.png");
  expect_unwritable(folder_);
  // A pipe of our own, not a device: with the check broken, root would replace the device.
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_unwritable(pipe);
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST_F(GreyImageTest, KeepsTheOldFileWhenTheDiskIsFull) {
  const fs::path path = folder_ / "picture.png";
  write_grey16_png(path, 4, 3, kGrey16);
  constexpr int kSide = 300;
  std::vector<uint16_t> noise(size_t{kSide} * kSide);
  uint32_t state = 1;
  for (uint16_t& sample : noise) {
    state = state * 1664525U + 1013904223U;
    sample = static_cast<uint16_t>(state >> 16);
  }
  {
    const FileSizeLimit small(20);  // fails while flushing at the end
    EXPECT_THROW(write_grey16_png(path, 4, 3, kGrey16), RunError);
  }
  {
    const FileSizeLimit medium(65536);  // fails in the middle of the rows
    EXPECT_THROW(write_grey16_png(path, kSide, kSide, noise), RunError);
  }
  EXPECT_EQ(read_grey_image(path).samples, kGrey16);
  EXPECT_EQ(files_in_folder(), 1U);
}

}  // namespace
}  // namespace screed
