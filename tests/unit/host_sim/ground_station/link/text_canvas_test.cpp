// Pages of characters.
#include "host_sim/ground_station/link/text_canvas.h"

#include <gtest/gtest.h>

#include <limits>

namespace screed {
namespace {

TEST(TextCanvas, TextIsCutAtTheEdgesAndCountedInCharacters) {
  TextCanvas page(6, 2);
  EXPECT_EQ(page.text(0, 0, "0.5 °"), 5);
  page.text(4, 1, "abcdef");
  page.text(-1, 1, "xy");
  page.text(0, 7, "below");
  EXPECT_EQ(page.str(), "0.5 °\ny   ab\n");
}

TEST(TextCanvas, WhatIsNoUtf8IsAQuestionMark) {
  EXPECT_EQ(from_utf8("a\xFF"
                      "b\xC3"),
            U"a?b?");
  EXPECT_EQ(utf8(U'é') + utf8(U'█') + utf8(U'\U0001F916'), "é█🤖");
  EXPECT_EQ(from_utf8("é█🤖"), U"é█🤖");
}

TEST(TextCanvas, ABarGrowsFromItsMiddle) {
  TextCanvas page(9, 3);
  page.centred_bar(0, 0, 9, 0.5, CellStyle::kGood);
  page.centred_bar(0, 1, 9, -7.0, CellStyle::kGood);
  page.centred_bar(0, 2, 9, 0.0, CellStyle::kGood);
  EXPECT_EQ(page.str(), "····│██··\n████│····\n····│····\n");
}

TEST(TextCanvas, ACurveIsDrawnInDots) {
  TextCanvas page(2, 1);
  // From the lower left dot to the upper right one.
  const std::vector<CurvePoint> line = {{0.0, 0.0}, {3.0, 3.0}};
  page.curve(0, 0, 2, 1, line, {0.0, 3.0, 0.0, 3.0});
  EXPECT_EQ(page.str(), "⡠⠊\n");
  TextCanvas gap(2, 1);
  const std::vector<CurvePoint> broken = {
      {0.0, 0.0}, {1.0, std::numeric_limits<double>::quiet_NaN()}, {3.0, 9.0}};
  gap.curve(0, 0, 2, 1, broken, {0.0, 3.0, 0.0, 3.0});
  EXPECT_EQ(gap.str(), "⡀⠈\n");
}

TEST(TextCanvas, TextWithinAWidthEndsWithAnEllipsisWhenItIsCut) {
  TextCanvas page(10, 3);
  EXPECT_EQ(page.text_within(1, 0, 5, "0.5 °"), 6);
  EXPECT_EQ(page.text_within(1, 1, 4, "0.5 °"), 5);
  EXPECT_EQ(page.text_within(1, 2, 0, "gone"), 1);
  EXPECT_EQ(page.str(), " 0.5 °\n 0.5…\n\n");
}

TEST(TextCanvas, LinesAreBrokenBetweenWords) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(break_lines("to the °C and back", 6), (Lines{"to the", "°C and", "back"}));
  EXPECT_EQ(break_lines("a longerword b", 6), (Lines{"a", "longerword", "b"}));
  EXPECT_EQ(break_lines("", 6), Lines{""});
}

TEST(TextCanvas, AnAlarmedBoxIsRedWithItsTitle) {
  TextCanvas page(8, 2);
  page.box(0, 0, 8, 2, "t", CellStyle::kAlarm);
  for (int x = 0; x < 8; ++x) EXPECT_EQ(page.at(x, 0).style, CellStyle::kAlarm) << x;
  page.box(0, 0, 8, 2, "t");
  EXPECT_EQ(page.at(0, 0).style, CellStyle::kDim);
  EXPECT_EQ(page.at(3, 0).style, CellStyle::kTitle);
}

}  // namespace
}  // namespace screed
