// CSV files: cells, what is left out, and what is refused.
#include "host_sim/core/csv_file.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

using Cells = std::vector<std::string>;

class CsvFile : public ::testing::Test {
 protected:
  std::vector<CsvLine> read(const std::string& text) const {
    write_text(folder_.path() / "t.csv", text);
    return read_csv_file(folder_.path() / "t.csv");
  }
  /// What is said of a file with this text, from its name on.
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      const std::string what = error.what();
      return what.substr(what.find("t.csv"));
    }
    return "";
  }

  const TempFolder folder_;
};

TEST_F(CsvFile, CellsStandBetweenCommasWithoutTheirBlanks) {
  const std::vector<CsvLine> lines = read("a,b , c\n\t1,,3\n,,\nlast,no,newline");
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0].cells, (Cells{"a", "b", "c"}));
  EXPECT_EQ(lines[1].cells, (Cells{"1", "", "3"}));
  EXPECT_EQ(lines[2].cells, (Cells{"", "", ""}));
  EXPECT_EQ(lines[3].cells, (Cells{"last", "no", "newline"}));
}

TEST_F(CsvFile, QuotationsKeepCommasBlanksAndMarks) {
  const std::vector<CsvLine> lines = read("\"a,b\", \" c \" ,\"say \"\"go\"\"\",\"\"\n");
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].cells, (Cells{"a,b", " c ", "say \"go\"", ""}));
}

TEST_F(CsvFile, CommentsAndEmptyLinesAreLeftOutAndLinesStillCount) {
  const std::vector<CsvLine> lines = read("# what it is, for people\n\na,b\n  \n  # more\n1,2#3\n");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].line, 3);
  EXPECT_EQ(lines[1].line, 6);
  EXPECT_EQ(lines[1].cells, (Cells{"1", "2#3"}));
}

TEST_F(CsvFile, FilesOfSpreadsheetsAreRead) {
  const std::vector<CsvLine> lines = read("\xEF\xBB\xBF# note\r\na,b\r\n1,\"2\"\r\n");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].cells, (Cells{"a", "b"}));
  EXPECT_EQ(lines[1].cells, (Cells{"1", "2"}));
}

TEST_F(CsvFile, WhatIsNoTableIsRefusedWithItsLine) {
  EXPECT_EQ(refusal("a,b\n1,\"2\n3,4\n"),
            "t.csv:2: a quotation is not closed; a cell ends with its line");
  EXPECT_EQ(refusal("a\n\n\"2\"3,4\n"),
            "t.csv:3: '3' behind a closed quotation; \"\" is a quotation mark within it");
  EXPECT_THROW(read_csv_file(folder_.path() / "none.csv"), InputError);
  EXPECT_THROW(read_csv_file(folder_.path()), InputError);
}

}  // namespace
}  // namespace screed
