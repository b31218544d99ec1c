// INI files: what is read, and the line of everything that is wrong.
#include "host_sim/core/ini_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

class IniFile : public ::testing::Test {
 protected:
  std::filesystem::path path() const { return folder_.path() / "test.ini"; }
  std::vector<IniEntry> read(const std::string& text) {
    std::ofstream(path(), std::ios::binary) << text;
    return read_ini_file(path());
  }
  /// The message without the path, "" when nothing is wrong.
  std::string error_message(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.rfind(path().string(), 0), 0U) << what;
      EXPECT_EQ(what.find('\n'), std::string::npos);
      return what.substr(path().string().size());
    }
    return "";
  }

 private:
  const TempFolder folder_;
};

void expect_entry(const IniEntry& entry, const std::string& section, const std::string& key,
                  const std::string& value, int line) {
  EXPECT_EQ(entry.section, section);
  EXPECT_EQ(entry.key, key);
  EXPECT_EQ(entry.value, value);
  EXPECT_EQ(entry.line, line);
}

TEST_F(IniFile, SectionsKeysCommentsAndLineNumbers) {
  const auto entries = read(
      "; a comment\n"
      "first = 1\n"
      "\n"
      "# another\n"
      "[one]\n"
      "x=2 ; behind\n"
      "y  =  a value with spaces   # behind\n"
      "[two]  ; behind a section\n"
      "x = 3");
  ASSERT_EQ(entries.size(), 4U);
  expect_entry(entries[0], "", "first", "1", 2);
  expect_entry(entries[1], "one", "x", "2", 6);
  expect_entry(entries[2], "one", "y", "a value with spaces", 7);
  expect_entry(entries[3], "two", "x", "3", 9);
}

TEST_F(IniFile, CommentSignsWithinAWordBelongToTheValue) {
  const auto entries = read("a = x#y;z\nb = # nothing\nc = ; nothing\nd = v\t# tab\n");
  ASSERT_EQ(entries.size(), 4U);
  EXPECT_EQ(entries[0].value, "x#y;z");
  EXPECT_EQ(entries[1].value, "");
  EXPECT_EQ(entries[2].value, "");
  EXPECT_EQ(entries[3].value, "v");
}

TEST_F(IniFile, IndentedLinesAreLinesOfTheirOwn) {
  const auto entries = read("[a]\n  x = 1\n\ty = 2\n   [b]\n  ; comment\n  x = 3\n");
  ASSERT_EQ(entries.size(), 3U);
  expect_entry(entries[0], "a", "x", "1", 2);
  expect_entry(entries[1], "a", "y", "2", 3);
  expect_entry(entries[2], "b", "x", "3", 6);
}

TEST_F(IniFile, LineEndsOfWindowsAndAByteOrderMark) {
  const auto entries = read("\xEF\xBB\xBF[a]\r\n\r\nx = 1\r\ny = two words\r\n");
  ASSERT_EQ(entries.size(), 2U);
  expect_entry(entries[0], "a", "x", "1", 3);
  expect_entry(entries[1], "a", "y", "two words", 4);
}

TEST_F(IniFile, AnEmptyFileHasNoEntries) {
  EXPECT_TRUE(read("").empty());
  EXPECT_TRUE(read("\n\n; nothing\n").empty());
}

TEST_F(IniFile, ASectionMayComeAgain) {
  const auto entries = read("[a]\nx=1\n[b]\nx=1\n[a]\ny=2\n");
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(entries[2].section, "a");
}

TEST_F(IniFile, EveryKindOfBadLineIsNamed) {
  const std::string neither = ": neither [section] nor 'key = value' nor a comment";
  EXPECT_EQ(error_message("[a]\nx = 1\njust words\n"), ":3" + neither);
  EXPECT_EQ(error_message("x = 1\n\n[never closed\ny = 1\n"), ":3" + neither);
  EXPECT_EQ(error_message("\n\n]\n"), ":3" + neither);
  EXPECT_EQ(error_message("[a]\r\nwords\r\n"), ":2" + neither);
  EXPECT_EQ(error_message("[a]\n   words\n"), ":2" + neither);
  EXPECT_EQ(error_message("\n[a] x = 1\n"),
            ":2: text behind [section]; a key stands in a line of its own");
}

TEST_F(IniFile, DuplicateKeysNameBothLines) {
  EXPECT_EQ(error_message("[a]\nx=1\n[b]\nx=1\n[a]\ny=1\nx=2\n"),
            ":7: key 'x' is given twice in [a], first in line 2");
  EXPECT_EQ(error_message("x=1\n\nx=1\n"),
            ":3: key 'x' is given twice before the first section, first in line 1");
}

TEST_F(IniFile, LongLinesAreRefusedNotCut) {
  EXPECT_EQ(read("k = " + std::string(194, 'x') + "\n").at(0).value.size(), 194U);
  for (const size_t length : {195U, 196U, 1000U, 100000U}) {
    EXPECT_EQ(error_message("a = 1\nk = " + std::string(length, 'x') + "\nb = 1\n"),
              ":2: line too long; at most 198 characters");
  }
  EXPECT_EQ(error_message("a = 1\n; " + std::string(500, '-') + "\n"),
            ":2: line too long; at most 198 characters");
}

TEST_F(IniFile, OfTwoComplaintsTheFirstIsTold) {
  EXPECT_EQ(error_message("words\nx=1\nx=2\n").substr(0, 3), ":1:");
  EXPECT_EQ(error_message("x=1\nx=2\nwords\n").substr(0, 3), ":2:");
  EXPECT_EQ(error_message("x=1\nx=2\n" + std::string(500, 'x') + "\n").substr(0, 3), ":2:");
  EXPECT_EQ(error_message("words\n" + std::string(500, 'x') + "\n").substr(0, 3), ":1:");
  EXPECT_EQ(error_message("[a] b\nwords\n").substr(0, 3), ":1:");
}

TEST_F(IniFile, MissingFilesAndFolders) {
  EXPECT_THROW(read_ini_file("/nowhere/at/all.ini"), InputError);
  EXPECT_THROW(read_ini_file(::testing::TempDir()), InputError);
}

TEST_F(IniFile, BinaryContentEndsWithOneLine) {
  std::string text;
  for (int i = 0; i < 4096; ++i) text.push_back(static_cast<char>((i * 7919) >> 3));
  EXPECT_NE(error_message(text), "");
}

TEST(IniOverride, SectionKeyAndValue) {
  expect_entry(parse_override("map.size=4"), "map", "size", "4", 0);
  expect_entry(parse_override(" map.size = 4 "), "map", "size", "4", 0);
  expect_entry(parse_override("output_directory_prefix=a.b=c"), "", "output_directory_prefix",
               "a.b=c", 0);
  expect_entry(parse_override("a.b="), "a", "b", "", 0);
  EXPECT_THROW(parse_override("map.size"), InputError);
  EXPECT_THROW(parse_override("=4"), InputError);
  EXPECT_THROW(parse_override(""), InputError);
}

}  // namespace
}  // namespace screed
