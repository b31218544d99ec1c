// Charts of numbers as SVG: lines or bars with error bars, axes with round ticks, a legend. Knows
// numbers and words, nothing of what they mean. The same chart gives the same bytes everywhere.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/render/chart/chart_parts.h"

namespace screed {

enum class ChartKind : std::uint8_t {
  kLines,
  kBars,  ///< one group a category; x counts the categories from 0
};

struct Chart {
  ChartKind kind = ChartKind::kLines;
  std::string title;
  std::string subtitle;
  std::string x_label;
  std::string y_label;
  std::vector<ChartSeries> series;
  std::vector<std::string> categories;  ///< names for x = 0, 1, 2, ... in place of numbers
  bool from_zero = true;                ///< the y axis begins at 0, when no value lies below
  bool value_labels = false;            ///< write each bar's value above it, where it fits
  int width_px = 760;                   ///< kMinChartWidth_px..kMaxChartSide_px
  int height_px = 460;                  ///< kMinChartHeight_px..kMaxChartSide_px
};

/// The text of an SVG file. Throws InputError when there is no point at all, a number is not
/// finite, or the size is out of range.
std::string chart_svg(const Chart& chart);

/// Writes it; the file appears complete or not at all. Throws RunError when it cannot be written.
void write_chart(const std::filesystem::path& path, const Chart& chart);

}  // namespace screed
