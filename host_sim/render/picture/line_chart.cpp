// SVG charts.
#include "host_sim/render/picture/line_chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string_view>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/map_frame.h"

namespace screed {
namespace {

constexpr double kLetterWidth = 6.6;  // of the tick font, on average; SVG cannot measure
constexpr const char* kInk = "#22262b";
constexpr const char* kFaintInk = "#5b636b";
constexpr const char* kGrid = "#e3e6e9";

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f", value);
  std::string_view view(text);
  while (view.back() == '0') view.remove_suffix(1);
  if (view.back() == '.') view.remove_suffix(1);
  return view == "-0" ? "0" : std::string(view);
}

/// For people: groups of three digits.
std::string tick_text(double value, int decimals) {
  char text[60];
  std::snprintf(text, sizeof text, "%.*f", decimals, std::fabs(value));
  std::string grouped = text;
  const size_t point = std::min(grouped.find('.'), grouped.size());
  for (size_t at = point; at > 3; at -= 3) grouped.insert(at - 3, "\u2009");
  return (value < 0.0 ? "\u2212" : "") + grouped;
}

std::string escaped(const std::string& words) {
  std::string out;
  for (const char c : words) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string hex(Color color) {
  const auto byte = [](double part) {
    return static_cast<unsigned>(std::lround(std::clamp(part, 0.0, 1.0) * 255.0));
  };
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", byte(color.red), byte(color.green),
                byte(color.blue));
  return text;
}

/// Letters, not bytes, of UTF-8.
double letters(const std::string& words) {
  return static_cast<double>(
      std::count_if(words.begin(), words.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

/// Collects SVG elements.
class Svg {
 public:
  Svg(int width, int height) {
    out_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(width) +
           "\" height=\"" + std::to_string(height) + "\" viewBox=\"0 0 " + std::to_string(width) +
           " " + std::to_string(height) +
           "\" font-family=\"'DejaVu Sans', Verdana, Arial, sans-serif\">\n"
           "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  }
  void line(double x1, double y1, double x2, double y2, const std::string& color, double width) {
    out_ += "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) +
            "\" y2=\"" + number(y2) + "\" stroke=\"" + color + "\" stroke-width=\"" +
            number(width) + "\"/>\n";
  }
  void polyline(const std::vector<std::pair<double, double>>& points, const std::string& color) {
    out_ += "<polyline fill=\"none\" stroke=\"" + color +
            "\" stroke-width=\"2\" stroke-linejoin=\"round\" stroke-linecap=\"round\" points=\"";
    for (const auto& [x, y] : points) out_ += number(x) + "," + number(y) + " ";
    out_.back() = '"';
    out_ += "/>\n";
  }
  void circle(double x, double y, double radius, const std::string& color) {
    out_ += "<circle cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"" + number(radius) +
            "\" fill=\"" + color + "\" stroke=\"#ffffff\" stroke-width=\"1.2\"/>\n";
  }
  void dot(double x, double y, const std::string& color) {
    out_ += "<circle cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"1.6\" fill=\"" + color +
            "\" fill-opacity=\"0.45\"/>\n";
  }
  void rectangle(double x, double y, double width, double height, const std::string& color,
                 double round) {
    out_ += "<rect x=\"" + number(x) + "\" y=\"" + number(y) + "\" width=\"" + number(width) +
            "\" height=\"" + number(height) + "\" fill=\"" + color + "\" rx=\"" + number(round) +
            "\"/>\n";
  }
  /// anchor: start, middle or end. turned: reads upwards.
  void text(double x, double y, const std::string& words, double size, const std::string& color,
            const char* anchor, bool bold = false, bool turned = false) {
    if (words.empty()) return;
    out_ += "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" font-size=\"" + number(size) +
            "\" fill=\"" + color + "\" text-anchor=\"" + anchor + "\"";
    if (bold) out_ += " font-weight=\"bold\"";
    if (turned) out_ += " transform=\"rotate(-90 " + number(x) + " " + number(y) + ")\"";
    out_ += ">" + escaped(words) + "</text>\n";
  }
  std::string finish() { return out_ + "</svg>\n"; }

 private:
  std::string out_;
};

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// At least a little wide.
  void open() {
    if (low < high) return;
    const double margin = low == 0.0 ? 1.0 : std::fabs(low) * 0.1;
    low -= margin;
    high += margin;
  }
};

/// One axis: values to pixels, and its ticks.
struct Axis {
  Ticks ticks;
  double low = 0.0;
  double high = 1.0;
  double begin_px = 0.0;
  double end_px = 1.0;

  double operator()(double value) const {
    return begin_px + (value - low) / (high - low) * (end_px - begin_px);
  }
};

/// Round ticks of which the first and the last enclose the range, which grows to them.
Ticks ticks_around(Range& range, int about) {
  Ticks ticks = round_ticks(range.low, range.high, about);
  constexpr double kSlack = 1e-9;  // of a step
  const double first = std::floor(range.low / ticks.step + kSlack);
  const double last = std::ceil(range.high / ticks.step - kSlack);
  ticks.values.clear();
  for (int i = 0; first + i <= last; ++i) ticks.values.push_back((first + i) * ticks.step);
  range.low = ticks.values.front();
  range.high = ticks.values.back();
  return ticks;
}

void check(const Chart& chart) {
  if (chart.width_px < 320 || chart.width_px > 4000 || chart.height_px < 240 ||
      chart.height_px > 4000) {
    throw InputError("chart: " + std::to_string(chart.width_px) + "x" +
                     std::to_string(chart.height_px) + " px; allowed is 320x240 to 4000x4000");
  }
  bool any = false;
  for (const ChartSeries& series : chart.series) {
    for (const ChartPoint& point : series.points) {
      any = true;
      if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.error)) {
        throw InputError("chart '" + chart.title + "': a number of '" + series.label +
                         "' is not finite");
      }
    }
  }
  if (!any) throw InputError("chart '" + chart.title + "': nothing to draw");
}

class Drawing {
 public:
  explicit Drawing(const Chart& chart) : chart_(chart), svg_(chart.width_px, chart.height_px) {
    lay_out();
  }

  std::string draw() {
    words();
    axes();
    for (size_t i = 0; i < chart_.series.size(); ++i) {
      if (chart_.kind == ChartKind::kBars) {
        bars(i);
      } else {
        lines(i);
      }
    }
    legend();
    return svg_.finish();
  }

 private:
  bool has_categories() const { return !chart_.categories.empty(); }
  std::string color(size_t series) const { return hex(category_color(series)); }

  void lay_out() {
    Range x_range;
    Range y_range;
    for (const ChartSeries& series : chart_.series) {
      for (const ChartPoint& point : series.points) {
        x_range.add(point.x);
        y_range.add(point.y - point.error);
        y_range.add(point.y + point.error);
      }
    }
    if ((chart_.from_zero || chart_.kind == ChartKind::kBars) && y_range.low >= 0.0) {
      y_range.low = 0.0;
    }
    y_range.open();
    y_.ticks = ticks_around(y_range, chart_.height_px / 65);
    y_.low = y_range.low;
    y_.high = y_range.high;

    if (has_categories()) {
      x_.low = -0.5;
      x_.high = static_cast<double>(chart_.categories.size()) - 0.5;
    } else {
      x_range.open();
      x_.ticks = round_ticks(x_range.low, x_range.high, chart_.width_px / 70);
      // Only as wide as the points, with a little air.
      const double air = 0.03 * (x_range.high - x_range.low);
      x_.low = x_range.low - air;
      x_.high = x_range.high + air;
      std::erase_if(x_.ticks.values,
                    [this](double tick) { return tick < x_.low || tick > x_.high; });
    }

    double widest = 0.0;
    for (const double tick : y_.ticks.values) {
      widest = std::max(widest, letters(tick_text(tick, y_.ticks.decimals)));
    }
    x_.begin_px = 24.0 + (chart_.y_label.empty() ? 0.0 : 22.0) + widest * kLetterWidth;
    x_.end_px = chart_.width_px - 24.0;
    const bool has_legend = std::any_of(chart_.series.begin(), chart_.series.end(),
                                        [](const ChartSeries& s) { return !s.label.empty(); });
    legend_y_ = 28.0 + (chart_.title.empty() ? 0.0 : 20.0) + (chart_.subtitle.empty() ? 0.0 : 20.0);
    y_.end_px = legend_y_ + (has_legend ? 24.0 : 4.0);
    y_.begin_px = chart_.height_px - 34.0 - (chart_.x_label.empty() ? 0.0 : 22.0);
  }

  void words() {
    double y = 26.0;
    svg_.text(x_.begin_px, y, chart_.title, 16.0, kInk, "start", true);
    if (!chart_.title.empty()) y += 20.0;
    svg_.text(x_.begin_px, y, chart_.subtitle, 12.0, kFaintInk, "start");
    svg_.text((x_.begin_px + x_.end_px) / 2.0, chart_.height_px - 14.0, chart_.x_label, 13.0, kInk,
              "middle");
    svg_.text(20.0, (y_.begin_px + y_.end_px) / 2.0, chart_.y_label, 13.0, kInk, "middle", false,
              true);
  }

  void axes() {
    for (const double tick : y_.ticks.values) {
      svg_.line(x_.begin_px, y_(tick), x_.end_px, y_(tick), kGrid, 1.0);
      svg_.text(x_.begin_px - 8.0, y_(tick) + 4.0, tick_text(tick, y_.ticks.decimals), 12.0,
                kFaintInk, "end");
    }
    svg_.line(x_.begin_px, y_.begin_px, x_.end_px, y_.begin_px, kInk, 1.2);
    const double below = y_.begin_px + 19.0;
    if (has_categories()) {
      for (size_t i = 0; i < chart_.categories.size(); ++i) {
        svg_.text(x_(static_cast<double>(i)), below, chart_.categories[i], 12.0, kFaintInk,
                  "middle");
      }
      return;
    }
    for (const double tick : x_.ticks.values) {
      svg_.line(x_(tick), y_.begin_px, x_(tick), y_.begin_px + 5.0, kInk, 1.2);
      svg_.text(x_(tick), below, tick_text(tick, x_.ticks.decimals), 12.0, kFaintInk, "middle");
    }
  }

  void error_bar(double x_px, const ChartPoint& point, const std::string& ink) {
    if (point.error <= 0.0) return;
    const double top = y_(point.y + point.error);
    const double bottom = y_(point.y - point.error);
    svg_.line(x_px, top, x_px, bottom, ink, 1.4);
    svg_.line(x_px - 4.0, top, x_px + 4.0, top, ink, 1.4);
    svg_.line(x_px - 4.0, bottom, x_px + 4.0, bottom, ink, 1.4);
  }

  void lines(size_t index) {
    const ChartSeries& series = chart_.series[index];
    std::vector<std::pair<double, double>> line_points;
    line_points.reserve(series.points.size());
    for (const ChartPoint& point : series.points)
      line_points.emplace_back(x_(point.x), y_(point.y));
    if (!series.joined) {
      for (const auto& [x, y] : line_points) svg_.dot(x, y, color(index));
      return;
    }
    if (line_points.size() > 1) svg_.polyline(line_points, color(index));
    for (size_t i = 0; i < line_points.size(); ++i) {
      error_bar(line_points[i].first, series.points[i], color(index));
      if (series.markers)
        svg_.circle(line_points[i].first, line_points[i].second, 4.2, color(index));
    }
  }

  void bars(size_t index) {
    const double slot = x_(1.0) - x_(0.0);
    const auto count = static_cast<double>(chart_.series.size());
    const double width = std::min(90.0, slot * 0.72 / count);
    for (const ChartPoint& point : chart_.series[index].points) {
      const double center =
          x_(point.x) + (static_cast<double>(index) - (count - 1.0) / 2.0) * width;
      const double from = y_(std::clamp(0.0, y_.low, y_.high));
      const double to = y_(point.y);
      svg_.rectangle(center - width / 2.0 + 1.0, std::min(from, to), width - 2.0,
                     std::fabs(from - to), color(index), 2.0);
      error_bar(center, point, kInk);
      const std::string value = tick_text(point.y, value_decimals());
      if (chart_.value_labels && letters(value) * kLetterWidth < width * 1.25) {
        svg_.text(center, y_(point.y + point.error) - 6.0, value, 11.0, kInk, "middle");
      }
    }
  }
  /// Values are written with one digit more than the axis, whole numbers as such.
  int value_decimals() const { return y_.ticks.step >= 10.0 ? 0 : y_.ticks.decimals + 1; }

  void legend() {
    double x = x_.begin_px;
    for (size_t i = 0; i < chart_.series.size(); ++i) {
      const std::string& label = chart_.series[i].label;
      if (label.empty()) continue;
      svg_.rectangle(x, legend_y_ - 10.0, 12.0, 12.0, color(i), 2.0);
      svg_.text(x + 18.0, legend_y_, label, 12.0, kInk, "start");
      x += 18.0 + letters(label) * 7.4 + 20.0;
    }
  }

  const Chart& chart_;
  Svg svg_;
  Axis x_;
  Axis y_;
  double legend_y_ = 0.0;
};

}  // namespace

std::string chart_svg(const Chart& chart) {
  check(chart);
  return Drawing(chart).draw();
}

void write_chart(const std::filesystem::path& path, const Chart& chart) {
  write_file(path, chart_svg(chart));
}

}  // namespace screed
