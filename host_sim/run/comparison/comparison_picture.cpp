#include "host_sim/run/comparison/comparison_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/statistics.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "host_sim/render/chart/path_map.h"
#include "host_sim/render/chart/plot_plan.h"
#include "host_sim/render/chart/stacked_chart.h"
#include "host_sim/render/chart/svg.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/ground_painter.h"

namespace screed {
namespace {

constexpr int kWidth_px = 1240;
constexpr int kHeight_px = 1080;
constexpr double kHead_px = 96.0;
constexpr double kMap_px = 590.0;  // width of the left column

constexpr std::array<const char*, 2> kRunNames = {"A", "B"};
/// Wine and teal: none of them the colour of a state, nor easily taken for one.
constexpr std::array<Color, 2> kRunColors = {{{0.56, 0.05, 0.20}, {0.05, 0.58, 0.62}}};

/// Every pixel of the ground as this colour of its node.
template <class ColorOfNode>
MapImage image_of(const HeightMapGeometry& g, const ColorOfNode& color_of_node) {
  constexpr std::uint32_t kMaxSide_px = 1000;
  const std::uint32_t step =
      std::max<std::uint32_t>(1, (std::max(g.nx, g.ny) + kMaxSide_px - 1) / kMaxSide_px);
  MapImage image;
  const double half = 0.5 * g.spacing_m;
  image.ground = {g.origin_x_m - half, g.origin_x_m + g.nx * g.spacing_m - half,
                  g.origin_y_m - half, g.origin_y_m + g.ny * g.spacing_m - half};
  image.width = static_cast<int>((g.nx + step - 1) / step);
  image.height = static_cast<int>((g.ny + step - 1) / step);
  image.rgb.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                    3);
  for (int row = image.height - 1; row >= 0; --row) {
    for (int column = 0; column < image.width; ++column) {
      const Color color = color_of_node(static_cast<std::uint32_t>(column) * step,
                                        static_cast<std::uint32_t>(row) * step, step);
      for (const double part : {color.red, color.green, color.blue}) {
        image.rgb.push_back(
            static_cast<std::uint8_t>(std::lround(std::clamp(part, 0.0, 1.0) * 255.0)));
      }
    }
  }
  return image;
}

/// The terrain as a faint grey relief, for paths to be seen on it.
MapImage relief_image(const HeightMap& map) {
  const HeightMapGeometry& g = map.geometry;
  const auto height = [&](std::uint32_t ix, std::uint32_t iy) {
    return map.heights[std::size_t{std::min(iy, g.ny - 1)} * g.nx + std::min(ix, g.nx - 1)] *
           g.unit_m;
  };
  return image_of(g, [&](std::uint32_t ix, std::uint32_t iy, std::uint32_t step) {
    const double run = g.spacing_m * step;
    const Relief slope{(height(ix + step, iy) - height(ix, iy)) / run,
                       (height(ix, iy + step) - height(ix, iy)) / run};
    const double grey = std::clamp(0.62 + 0.28 * light(slope, 1.5), 0.0, 0.97);
    return Color{grey, grey, grey};
  });
}

/// The difference in diverging colours; of several nodes in a pixel the one that differs most.
MapImage difference_image(const HeightMapGeometry& g, const std::vector<double>& height_m,
                          double limit_m) {
  return image_of(g, [&](std::uint32_t ix, std::uint32_t iy, std::uint32_t step) {
    double most = 0.0;
    for (std::uint32_t y = iy; y < std::min(iy + step, g.ny); ++y) {
      for (std::uint32_t x = ix; x < std::min(ix + step, g.nx); ++x) {
        const double height = height_m[std::size_t{y} * g.nx + x];
        if (std::abs(height) > std::abs(most)) most = height;
      }
    }
    return difference_color(most / limit_m);
  });
}

/// The line breaks where the robot goes over the edge of a wrapped bed.
MapPath path_of(const ComparedRun& run, const std::string& label, Color color) {
  MapPath path{label, {}, {}, color};
  path.points.reserve(run.trace.size());
  const TracePoint* last = nullptr;
  for (const TracePoint& point : run.trace) {
    if (!std::isfinite(point.x_m) || !std::isfinite(point.y_m)) continue;
    if (last != nullptr && (point.beds_x != last->beds_x || point.beds_y != last->beds_y)) {
      path.breaks.push_back(path.points.size());
    }
    path.points.push_back({point.x_m, point.y_m});
    last = &point;
  }
  return path;
}

/// The part of a bed in which something happened: both paths, and where the terrains differ, with
/// room for the robots. Nothing when that is most of the bed.
std::optional<MapRectangle> view_of(const SessionComparison& comparison) {
  constexpr double kRoom_m = 0.3;
  constexpr double kMinRatio = 0.7;  // of the sides
  constexpr double kMaxShareOfBed = 0.6;
  ValueRange x;
  ValueRange y;
  for (const ComparedRun& run : comparison.runs) {
    for (const TracePoint& point : run.trace) {
      x.add(point.x_m);
      y.add(point.y_m);
    }
  }
  const HeightMapGeometry& g = comparison.runs[0].terrain->geometry;
  const std::vector<double>& height_m = comparison.terrain.height_m;
  for (std::size_t i = 0; i < height_m.size(); ++i) {
    if (height_m[i] == 0.0) continue;
    const std::size_t column = i % g.nx;
    const std::size_t row = i / g.nx;
    x.add(g.origin_x_m + static_cast<double>(column) * g.spacing_m);
    y.add(g.origin_y_m + static_cast<double>(row) * g.spacing_m);
  }
  const double width = x.high - x.low + 2.0 * kRoom_m;
  const double height = y.high - y.low + 2.0 * kRoom_m;
  const double half_width = 0.5 * std::max(width, kMinRatio * height);
  const double half_height = 0.5 * std::max(height, kMinRatio * width);
  const double middle_x = 0.5 * (x.low + x.high);
  const double middle_y = 0.5 * (y.low + y.high);
  const MapRectangle view{
      std::max(middle_x - half_width, g.origin_x_m),
      std::min(middle_x + half_width, g.origin_x_m + (g.nx - 1) * g.spacing_m),
      std::max(middle_y - half_height, g.origin_y_m),
      std::min(middle_y + half_height, g.origin_y_m + (g.ny - 1) * g.spacing_m)};
  const double area = (view.x_max - view.x_min) * (view.y_max - view.y_min);
  const double bed = (g.nx - 1) * g.spacing_m * (g.ny - 1) * g.spacing_m;
  const bool some = view.x_min < view.x_max && view.y_min < view.y_max;
  return some && area < kMaxShareOfBed * bed ? std::optional(view) : std::nullopt;
}

PathMap path_map(const SessionComparison& comparison, const std::array<std::string, 2>& labels) {
  PathMap map;
  map.title = "paths";
  for (std::size_t i = 0; i < 2; ++i) {
    map.paths.push_back(
        path_of(comparison.runs[i], std::string(kRunNames[i]) + ": " + labels[i], kRunColors[i]));
  }
  if (comparison.terrain.not_comparable.empty()) {
    map.view = view_of(comparison);
    if (comparison.runs[0].before.has_value()) {
      map.image = relief_image(*comparison.runs[0].before);
      map.title += comparison.same_start ? " over the terrain at the start"
                                         : " over A's terrain at the start";
    }
  }
  map.title += " (ring: start, square: end)";
  return map;
}

PathMap difference_map(const SessionComparison& comparison) {
  const TerrainDifference& terrain = comparison.terrain;
  const double limit = difference_limit_m(terrain.height_m);
  PathMap map;
  map.view = view_of(comparison);
  map.title = comparison.same_terrain || terrain.rms_m == 0.0 ? "terrain at the end: no difference"
                                                              : "terrain at the end: B above A";
  map.image = difference_image(comparison.runs[0].terrain->geometry, terrain.height_m, limit);
  map.scale = ColorScale{
      -limit * kMmPerM, limit * kMmPerM, "B higher than A [mm]",
      [limit](double value_mm) { return difference_color(value_mm / (limit * kMmPerM)); }};
  return map;
}

ChartPanel deviation_panel(const SessionComparison& comparison, const char* title,
                           double (*value)(const DeviationPoint&), bool from_zero) {
  // In the ink of neither run: it is of both.
  ChartPanel panel{title, {{"B from A", {}, false, true, false, 0.0, kChartInk}}, {}, from_zero};
  for (const DeviationPoint& point : comparison.deviation) {
    const double y = value(point);
    if (std::isfinite(y)) panel.series[0].points.push_back({point.time_s, y});
  }
  return panel;
}

ChartPanel battery_panel(const SessionComparison& comparison) {
  ChartPanel panel{"battery [V]", {}, {}, false};
  for (std::size_t i = 0; i < 2; ++i) {
    // B is dashed, as on the map: where it covers A, A shows between the dashes.
    ChartSeries series{kRunNames[i], {}, false, true, i > 0, 0.0, kRunColors[i]};
    for (const TracePoint& point : comparison.runs[i].trace) {
      if (std::isfinite(point.battery_v)) series.points.push_back({point.time_s, point.battery_v});
    }
    panel.series.push_back(std::move(series));
  }
  return panel;
}

BandRow state_row(const ComparedRun& run, const std::string& label) {
  constexpr double kPeriod_s = 0.1;
  const SignalInfo& signal = *find_signal("leveling.state").signal;
  std::vector<StatePoint> points;
  points.reserve(run.trace.size());
  for (const TracePoint& point : run.trace) points.push_back({point.time_s, point.leveling_state});
  BandRow row{label, {}};
  const double end_s = run.trace.empty() ? 0.0 : run.trace.back().time_s;
  for (const BandInterval& it : band_intervals(points, kPeriod_s, 2.0 * kPeriod_s, end_s)) {
    row.bands.push_back(
        {it.begin, it.end, signal.text(it.value),
         state_color(static_cast<std::size_t>(std::max<std::int64_t>(0, it.value)))});
  }
  return row;
}

StackedChart deviation_chart(const SessionComparison& comparison) {
  StackedChart chart;
  chart.x_label = "time [s]";
  chart.x.add(0.0);
  if (!comparison.deviation.empty()) {
    chart.panels.push_back(deviation_panel(
        comparison, "position apart [mm]",
        [](const DeviationPoint& point) { return kMmPerM * point.position_m; }, true));
    chart.panels.push_back(deviation_panel(
        comparison, "heading, B from A [deg]",
        [](const DeviationPoint& point) { return kDegPerRad * point.heading_rad; }, false));
    // From 180 to -180 degrees the line has no way.
    chart.panels.back().series[0].jump = 180.0;
  }
  chart.panels.push_back(battery_panel(comparison));
  chart.panels.push_back({"",
                          {},
                          {state_row(comparison.runs[0], "states of A"),
                           state_row(comparison.runs[1], "states of B")}});
  return chart;
}

std::string verdict(const SessionComparison& comparison) {
  if (comparison.identical()) return "identical";
  if (comparison.first.has_value()) {
    char text[200];
    std::snprintf(text, sizeof text, "first difference in tick %llu (%.2f s): %s",
                  static_cast<unsigned long long>(comparison.first->tick), comparison.first->time_s,
                  comparison.first->column.c_str());
    return text;
  }
  if (comparison.common_ticks == 0) return "no tick that both runs have";
  return "equal in all " + std::to_string(comparison.common_ticks) + " common ticks";
}

void draw_head(Svg& svg, const SessionComparison& comparison,
               const std::array<std::string, 2>& labels) {
  constexpr double kHeadLeft_px = 24.0;
  double y = 30.0;
  svg.text({kHeadLeft_px, y}, svg_fitted(verdict(comparison), 17.0, kWidth_px - 2.0 * kHeadLeft_px),
           {.size_px = 17.0, .bold = true});
  for (std::size_t i = 0; i < 2; ++i) {
    const ComparedRun& run = comparison.runs[i];
    y += 24.0;
    char facts[200];
    std::snprintf(facts, sizeof facts, ", %s, seed %llu, %.2f s, ends %s", run.name.c_str(),
                  static_cast<unsigned long long>(run.seed), run.end.time_s,
                  run.frames > 0 ? run.end.state.c_str() : "before the first tick");
    svg.rectangle({kHeadLeft_px, y - 11.0, 13.0, 13.0}, kRunColors[i], 2.0);
    svg.text({kHeadLeft_px + 20.0, y},
             svg_fitted(std::string(kRunNames[i]) + ": " + labels[i] + facts, 13.0,
                        kWidth_px - 3.0 * kHeadLeft_px),
             {.size_px = 13.0});
  }
}

/// What differs in the configuration, as far as there is room.
void draw_configuration(Svg& svg, const SessionComparison& comparison, const PixelBox& box) {
  constexpr double kRow_px = 19.0;
  const std::vector<KeyDifference>& keys = comparison.configuration;
  double y = box.top + 20.0;
  const std::string count = keys.empty() ? "configuration: the same"
                                         : "configuration: " + std::to_string(keys.size()) +
                                               (keys.size() == 1 ? " key differs" : " keys differ");
  svg.text({box.left, y}, count, {.size_px = 14.0, .bold = true});
  const double column = box.width * 0.29;
  const double key_width = box.width - 2.0 * column;
  const auto row = [&](const std::string& key, const std::string& a, const std::string& b,
                       Color color) {
    y += kRow_px;
    constexpr double kSize_px = 11.5;
    svg.text({box.left, y}, svg_fitted(key, kSize_px, key_width - 10.0),
             {.size_px = kSize_px, .color = color});
    svg.text({box.left + key_width, y}, svg_fitted(a, kSize_px, column - 10.0),
             {.size_px = kSize_px, .color = color});
    svg.text({box.left + key_width + column, y}, svg_fitted(b, kSize_px, column - 10.0),
             {.size_px = kSize_px, .color = color});
  };
  if (keys.empty()) return;
  row("key", "A", "B", kChartFaintInk);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (y + 2.0 * kRow_px > box.top + box.height && i + 1 < keys.size()) {
      row("and " + std::to_string(keys.size() - i) + " more", "", "", kChartFaintInk);
      return;
    }
    row(keys[i].key, keys[i].a.value_or("not set"), keys[i].b.value_or("not set"), kChartInk);
  }
}

}  // namespace

double difference_limit_m(const std::vector<double>& height_m) {
  constexpr double kMinScale_m = 1e-4;
  constexpr double kShare = 0.995;
  std::vector<double> sizes;
  for (const double height : height_m) {
    if (height != 0.0) sizes.push_back(std::abs(height));
  }
  if (sizes.empty()) return 1e-3;
  const double size = std::max(kMinScale_m, quantile(sizes, kShare));
  const double decade = std::pow(10.0, std::floor(std::log10(size)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (size <= factor * decade * (1.0 + 1e-9)) return factor * decade;
  }
  return 10.0 * decade;
}

std::string comparison_svg(const SessionComparison& comparison,
                           const std::array<std::string, 2>& labels) {
  if (comparison.runs[0].trace.empty() && comparison.runs[1].trace.empty()) {
    throw InputError("neither run has a frame to draw");
  }
  constexpr double kHalf_px = (kHeight_px - kHead_px) / 2.0;
  Svg svg(kWidth_px, kHeight_px);
  draw_head(svg, comparison, labels);
  draw_path_map(svg, path_map(comparison, labels), {8.0, kHead_px, kMap_px, kHalf_px});
  const PixelBox below{8.0, kHead_px + kHalf_px, kMap_px, kHalf_px - 8.0};
  if (comparison.terrain.not_comparable.empty()) {
    draw_path_map(svg, difference_map(comparison), below);
  } else {
    svg.text({below.left + 62.0, below.top + 20.0}, "terrain at the end: not compared",
             {.size_px = 14.0, .bold = true});
    svg.text({below.left + 62.0, below.top + 42.0},
             svg_fitted(comparison.terrain.not_comparable, 12.0, below.width - 70.0),
             {.size_px = 12.0});
  }
  const double right = kMap_px + 20.0;
  constexpr double kTable_px = 260.0;
  draw_stacked_chart(svg, deviation_chart(comparison),
                     {right, kHead_px, kWidth_px - right, kHeight_px - kHead_px - kTable_px});
  draw_configuration(svg, comparison,
                     {right + 24.0, kHeight_px - kTable_px, kWidth_px - right - 40.0, kTable_px});
  return svg.finish();
}

void write_comparison_picture(const std::filesystem::path& path,
                              const SessionComparison& comparison,
                              const std::array<std::string, 2>& labels) {
  write_svg_as_png(path, comparison_svg(comparison, labels), 1.0);
}

}  // namespace screed
