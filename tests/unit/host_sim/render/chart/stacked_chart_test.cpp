// Panels over one time axis, legends, maps of paths: where things stand in the SVG.
#include "host_sim/render/chart/stacked_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/grey_image.h"
#include "host_sim/render/chart/path_map.h"

namespace screed {
namespace {

/// The points of all lines, in their order.
std::vector<std::vector<Pixel>> lines_of(const std::string& svg) {
  std::vector<std::vector<Pixel>> lines;
  for (size_t at = svg.find(" points=\""); at != std::string::npos;
       at = svg.find(" points=\"", at + 1)) {
    std::vector<Pixel> line;
    const char* text = svg.c_str() + at + 9;
    Pixel point{};
    int read = 0;
    while (std::sscanf(text, " %lf,%lf%n", &point.x, &point.y, &read) == 2) {
      line.push_back(point);
      text += read;
    }
    lines.push_back(line);
  }
  return lines;
}

/// x, y, width, height of the rectangle of this colour.
PixelBox rectangle_of(const std::string& svg, const std::string& color) {
  const size_t at = svg.find("fill=\"" + color + "\"");
  if (at == std::string::npos) return {};
  PixelBox box{};
  EXPECT_EQ(std::sscanf(svg.c_str() + svg.rfind("<rect", at),
                        "<rect x=\"%lf\" y=\"%lf\" width=\"%lf\" height=\"%lf\"", &box.left,
                        &box.top, &box.width, &box.height),
            4);
  return box;
}

StackedChart two_units() {
  StackedChart chart;
  chart.title = "log";
  chart.x_label = "time [s]";
  chart.panels.push_back({"pitch [deg]", {{"pitch", {{0.0, -1.0}, {4.0, 1.0}}, false}}, {}, false});
  chart.panels.push_back({"battery [mV]",
                          {{"battery", {{0.0, 9000.0}, {2.0, 9500.0}, {4.0, 9100.0}}, false}},
                          {},
                          false});
  chart.panels.push_back({"", {}, {{"state", {{1.0, 3.0, "walk", {1.0, 0.0, 0.0}}}}}, false});
  return chart;
}

TEST(StackedChart, TimeIsTheSameInAllPanels) {
  const std::string svg = stacked_chart_svg(two_units());
  const auto lines = lines_of(svg);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0][0].x, lines[1][0].x);
  EXPECT_EQ(lines[0][1].x, lines[1][2].x);
  const double px_per_s = (lines[0][1].x - lines[0][0].x) / 4.0;
  const PixelBox band = rectangle_of(svg, "#ff0000");
  EXPECT_NEAR(band.left, lines[0][0].x + px_per_s, 0.02);
  EXPECT_NEAR(band.width, 2.0 * px_per_s, 0.02);
}

TEST(StackedChart, EachPanelHasItsOwnAxisBelowTheOneBefore) {
  const auto lines = lines_of(stacked_chart_svg(two_units()));
  const double pitch_low = lines[0][0].y;
  const double battery_high = lines[1][1].y;
  EXPECT_GT(battery_high, pitch_low);
  EXPECT_GT(lines[0][0].y - lines[0][1].y, 60.0) << "2 degrees are not lost beside 9000 mV";
  const std::string svg = stacked_chart_svg(two_units());
  for (const char* words : {">pitch [deg]<", ">battery [mV]<", ">time [s]<", ">state<", ">walk<"}) {
    EXPECT_NE(svg.find(words), std::string::npos) << words;
  }
}

TEST(StackedChart, NamesThatFitNoBandAreInTheLegend) {
  StackedChart chart = two_units();
  std::vector<ChartBand>& bands = chart.panels[2].rows[0].bands;
  bands.push_back({3.0, 3.01, "climb", {0.0, 0.0, 1.0}});
  bands.push_back({3.01, 3.02, "walk", {1.0, 0.0, 0.0}});
  const std::string svg = stacked_chart_svg(chart);
  const auto count = [&svg](const std::string& words) {
    int found = 0;
    for (size_t at = svg.find(words); at != std::string::npos; at = svg.find(words, at + 1))
      ++found;
    return found;
  };
  EXPECT_EQ(count(">climb<"), 1) << "in the legend";
  EXPECT_EQ(count(">walk<"), 1) << "in its long band";
  bands[1].end = 3.9;
  bands[2].begin = bands[2].end = 3.9;
  const std::string roomy = stacked_chart_svg(chart);
  EXPECT_EQ(roomy.find("width=\"12\" height=\"12\""), std::string::npos) << "no legend";
  EXPECT_NE(roomy.find(">climb<"), std::string::npos);
}

TEST(StackedChart, TheHeightIsThatAskedForOrWhatThePanelsNeed) {
  StackedChart chart = two_units();
  const auto height_of = [](const std::string& svg) {
    int height = 0;
    EXPECT_EQ(std::sscanf(svg.c_str() + svg.find(" height="), " height=\"%d\"", &height), 1);
    return height;
  };
  const int two = height_of(stacked_chart_svg(chart));
  chart.panels.push_back(chart.panels[0]);
  EXPECT_GT(height_of(stacked_chart_svg(chart)), two + 100);
  chart.height_px = 700;
  EXPECT_EQ(height_of(stacked_chart_svg(chart)), 700);
  chart.height_px = 250;
  EXPECT_THROW(stacked_chart_svg(chart), InputError);
}

TEST(StackedChart, ALineBreaksWhereItJumps) {
  StackedChart chart;
  ChartSeries heading{"heading", {{0.0, 178.0}, {1.0, 179.0}, {2.0, -179.0}, {3.0, -178.0}}, false};
  heading.jump = 180.0;
  chart.panels.push_back({"heading [deg]", {heading}, {}, false});
  const auto lines = lines_of(stacked_chart_svg(chart));
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].size(), 2U);
  EXPECT_EQ(lines[1].size(), 2U);
  chart.panels[0].series[0].jump = 0.0;
  EXPECT_EQ(lines_of(stacked_chart_svg(chart)).size(), 1U);
}

TEST(StackedChart, ALineDrawnOverAnotherMayShowIt) {
  StackedChart chart = two_units();
  EXPECT_EQ(stacked_chart_svg(chart).find("stroke-dasharray"), std::string::npos);
  chart.panels[0].series[0].dashed = true;
  chart.panels[0].series[0].color = Color{0.0, 1.0, 0.0};
  const std::string svg = stacked_chart_svg(chart);
  EXPECT_NE(svg.find("stroke-dasharray"), std::string::npos);
  EXPECT_NE(svg.find("stroke=\"#00ff00\""), std::string::npos);
}

TEST(StackedChart, AnAxisOfDistancesBeginsAtZeroAlsoWhenAllAreZero) {
  StackedChart chart;
  chart.panels.push_back({"apart [mm]", {{"B", {{0.0, 0.0}, {4.0, 0.0}}, false}}, {}, true});
  const std::string svg = stacked_chart_svg(chart);
  EXPECT_EQ(svg.find("\u2212"), std::string::npos) << "no negative tick";
  EXPECT_NE(svg.find(">1.0<"), std::string::npos);
  chart.panels[0].from_zero = false;
  EXPECT_NE(stacked_chart_svg(chart).find("\u2212"), std::string::npos);
}

TEST(StackedChart, LegendsEndInThePicture) {
  StackedChart chart;
  chart.width_px = 420;
  ChartPanel lines{"[deg]", {}, {}, false};
  for (const char* name : {"attitude.heading", "odometry.heading"}) {
    lines.series.push_back({name, {{0.0, -123.45}, {1.0, 9.0}}, false});
  }
  chart.panels = {lines, {"", {}, {{"heartbeat.emergency_stop", {{0.0, 1.0, "", {}}}}}, false}};
  const std::string svg = stacked_chart_svg(chart);
  size_t labels = 0;
  for (const char* name : {">attitude.", ">odometry."}) {
    const size_t at = svg.find(name);
    ASSERT_NE(at, std::string::npos);
    double left = 0.0;
    ASSERT_EQ(std::sscanf(svg.c_str() + svg.rfind("<text", at), "<text x=\"%lf\"", &left), 1);
    const std::string words = svg.substr(at + 1, svg.find('<', at) - at - 1);
    EXPECT_LE(left + svg_text_width_px(words, 12.0), 420.0) << words;
    ++labels;
  }
  EXPECT_EQ(labels, 2U);
}

TEST(StackedChart, AStateThatNeverHeldIsARowThatSaysSo) {
  StackedChart chart;
  chart.panels.push_back({"", {}, {{"stall_left", {}}}, false});
  EXPECT_THROW(stacked_chart_svg(chart), InputError);
  chart.x.add(0.0);
  chart.x.add(10.0);
  EXPECT_NE(stacked_chart_svg(chart).find(">stall_left<"), std::string::npos);
  EXPECT_NE(stacked_chart_svg(chart).find(">none<"), std::string::npos);
  chart.panels[0].rows[0].bands.push_back({1.0, 2.0, "", {}});
  EXPECT_EQ(stacked_chart_svg(chart).find(">none<"), std::string::npos);
}

TEST(StackedChart, RefusesWhatItCannotDraw) {
  StackedChart chart;
  EXPECT_THROW(stacked_chart_svg(chart), InputError);
  chart = two_units();
  chart.panels[0].series[0].points[0].y = std::nan("");
  EXPECT_THROW(stacked_chart_svg(chart), InputError);
  chart = two_units();
  chart.panels[2].rows[0].bands[0].end = 0.5;
  EXPECT_THROW(stacked_chart_svg(chart), InputError);
  chart = two_units();
  chart.width_px = 10;
  EXPECT_THROW(stacked_chart_svg(chart), InputError);
}

TEST(Legend, TakesMoreRowsInsteadOfLeavingThePicture) {
  const std::vector<LegendEntry> entries(9, {"a label of some length", {}});
  const std::vector<LegendPlace> places = legend_places(entries, 500.0);
  ASSERT_EQ(places.size(), 9U);
  size_t row = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    EXPECT_LE(places[i].left_px + 18.0 + svg_text_width_px(entries[i].label, 12.0), 500.0);
    EXPECT_GE(places[i].row, row);
    if (i > 0 && places[i].row == places[i - 1].row) {
      EXPECT_GT(places[i].left_px, places[i - 1].left_px);
    }
    row = places[i].row;
  }
  EXPECT_GE(row, 2U);
  EXPECT_EQ(legend_height_px(entries, 500.0), static_cast<double>(row + 1) * kLegendRow_px);
  EXPECT_EQ(legend_height_px({}, 500.0), 0.0);
}

TEST(Legend, StandsAboveTheDataOfItsPanel) {
  StackedChart chart;
  ChartPanel panel{"[mm]", {}, {}, false};
  for (int i = 0; i < 6; ++i) {
    panel.series.push_back({"a rather long name of a signal " + std::to_string(i),
                            {{0.0, 1.0 * i}, {1.0, 9.0}},
                            false});
  }
  chart.panels = {panel};
  const std::string svg = stacked_chart_svg(chart);
  double lowest_legend = 0.0;
  for (size_t at = svg.find("width=\"12\" height=\"12\""); at != std::string::npos;
       at = svg.find("width=\"12\" height=\"12\"", at + 1)) {
    double top = 0.0;
    EXPECT_EQ(std::sscanf(svg.c_str() + svg.rfind(" y=\"", at), " y=\"%lf\"", &top), 1);
    lowest_legend = std::max(lowest_legend, top + 12.0);
  }
  EXPECT_GT(lowest_legend, 0.0);
  for (const auto& line : lines_of(svg)) {
    for (const Pixel& point : line) EXPECT_GT(point.y, lowest_legend);
  }
}

TEST(SvgText, IsCutToItsRoomByWholeLetters) {
  EXPECT_EQ(svg_fitted("short", 12.0, 200.0), "short");
  const std::string cut =
      svg_fitted("\u00e4\u00f6\u00fc\u00e4\u00f6\u00fc\u00e4\u00f6\u00fc", 10.0, 30.0);
  EXPECT_LE(svg_text_width_px(cut, 10.0), 30.0);
  EXPECT_EQ(cut.substr(cut.size() - 3), "\u2026");
  EXPECT_EQ(cut.size() % 2, 1U) << "two bytes a letter, three of the ellipsis";
  EXPECT_EQ(svg_fitted("anything", 12.0, 1.0), "");
}

TEST(PathMap, IsTrueToScaleWhateverTheBox) {
  PathMap map;
  map.paths = {{"a", {{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}}}};
  for (const PixelBox& box : {PixelBox{0, 0, 900, 400}, PixelBox{0, 0, 400, 900}}) {
    Svg svg(900, 900);
    draw_path_map(svg, map, box);
    const auto lines = lines_of(svg.finish());
    ASSERT_EQ(lines.size(), 1U);
    const double east = lines[0][1].x - lines[0][0].x;
    const double north = lines[0][1].y - lines[0][2].y;
    EXPECT_NEAR(east, 2.0 * north, 0.05);
    EXPECT_GT(east, 100.0);
  }
}

TEST(PathMap, BreaksWhereAPathLeavesTheBed) {
  PathMap map;
  map.paths = {{"a", {{0.9, 0.0}, {0.95, 0.0}, {-0.95, 0.0}, {-0.9, 0.0}}, {2}}};
  Svg svg(600, 600);
  draw_path_map(svg, map, {0, 0, 600, 600});
  EXPECT_EQ(lines_of(svg.finish()).size(), 2U);
  map.paths[0].breaks.clear();
  Svg joined(600, 600);
  draw_path_map(joined, map, {0, 0, 600, 600});
  EXPECT_EQ(lines_of(joined.finish()).size(), 1U);
}

TEST(PathMap, RefusesNothingAndNoNumber) {
  Svg svg(600, 600);
  EXPECT_THROW(draw_path_map(svg, {}, {0, 0, 600, 600}), InputError);
  PathMap map;
  map.paths = {{"a", {{0.0, std::nan("")}}}};
  EXPECT_THROW(draw_path_map(svg, map, {0, 0, 600, 600}), InputError);
}

TEST(RgbPng, IsAPngOfThatSize) {
  const std::vector<std::uint8_t> rgb(3 * 5 * 7, 128);
  const std::vector<std::uint8_t> png = rgb_png(5, 7, rgb);
  ASSERT_GT(png.size(), 24U);
  EXPECT_EQ(png[1], 'P');
  EXPECT_EQ(png[19], 5);
  EXPECT_EQ(png[23], 7);
  EXPECT_EQ(rgb_png(5, 7, rgb), png);
}

}  // namespace
}  // namespace screed
