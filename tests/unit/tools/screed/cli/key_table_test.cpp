// The table of keys as people see it.
#include "tools/screed/cli/key_table.h"

#include <gtest/gtest.h>

namespace screed {
namespace {

TEST(KeyTable, IsAlignedAndWrapsInItsColumns) {
  const std::string rows =
      "| output |  | out | a folder | where run folders are made |\n"
      "| [map] size | m | 3 | a number 0.1..1000 | length of the longer side |\n"
      "| [map] gone |  |  | one, two, three, four, five, six, or seven |  |\n";
  EXPECT_EQ(
      aligned_key_table(rows, 88),
      "key         unit  default  range                               meaning\n"
      "output            out      a folder                            where run folders are\n"
      "                                                               made\n"
      "[map] size  m     3        a number 0.1..1000                  length of the longer side\n"
      "[map] gone                 one, two, three, four, five, six,\n"
      "                           or seven\n");
}

TEST(KeyTable, OnANarrowTerminalKeepsAColumnOfMeanings) {
  EXPECT_EQ(aligned_key_table("| k | s | 1 | 0..9 | of the robot and of nobody else |\n", 10),
            "key  unit  default  range  meaning\n"
            "k    s     1        0..9   of the robot and of\n"
            "                           nobody else\n");
}

}  // namespace
}  // namespace screed
