#include "host_sim/render/picture/terrain_picture.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/terrain_change.h"
#include "host_sim/physics/terrain/terrain_statistics.h"
#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/map_frame.h"
#include "host_sim/render/picture/path_overlay.h"
#include "host_sim/render/picture/relief.h"
#include "host_sim/render/picture/state_color.h"

namespace screed {
namespace {

constexpr Color kPaper{1.0, 1.0, 1.0};
constexpr double kMillimetres = 1000.0;

void require_side(const char* name, int value, int lowest) {
  constexpr int kHighest = 8000;
  if (value >= lowest && value <= kHighest) return;
  throw InputError(std::string("picture: ") + name + " = " + std::to_string(value) +
                   "; allowed: " + std::to_string(lowest) + " to " + std::to_string(kHighest));
}

void require_finite(const char* what, std::initializer_list<double> values) {
  for (const double value : values) {
    if (std::isfinite(value)) continue;
    throw InputError(std::string("picture: a ") + what +
                     " holds what is no number; allowed: finite metres and radians");
  }
}

void check_robot(const PictureOptions& options, const std::vector<PathPoint>& path,
                 const std::optional<RobotOutline>& outline) {
  for (const PathPoint& point : path) {
    if (point.state >= options.state_names.size()) {
      throw InputError("picture: path state " + std::to_string(point.state) + " has no name; " +
                       std::to_string(options.state_names.size()) + " states are named");
    }
    require_finite("path point", {point.x_m, point.y_m});
  }
  if (outline) require_finite("robot outline", {outline->x_m, outline->y_m, outline->heading_rad});
}

void check(const PictureOptions& options) {
  require_side("width_px", options.width_px, 800);
  require_side("height_px", options.height_px, 700);
  if (options.state_names.size() > kStateColors) {
    throw InputError("picture: " + std::to_string(options.state_names.size()) +
                     " state names; allowed: at most " + std::to_string(kStateColors));
  }
  check_robot(options, options.path, options.robot);
  for (const PictureRobot& robot : options.further_robots)
    check_robot(options, robot.path, robot.outline);
  if (options.heights) {
    const HeightRange& heights = *options.heights;
    require_finite("range of heights", {heights.low_m, heights.high_m});
    if (heights.low_m > heights.high_m)
      throw InputError("picture: heights from " + std::to_string(heights.low_m) + " to " +
                       std::to_string(heights.high_m) + " m; allowed: the lower one first");
  }
}

/// Central difference over two cells: smooth where the bilinear gradient jumps from cell to cell.
Relief smooth_gradient(const HeightField& field, double x, double y) {
  const double reach = field.spacing_m();
  const auto low = [&](double at, double edge) {
    return field.wrap() ? at - reach : std::max(at - reach, edge);
  };
  const auto high = [&](double at, double edge) {
    return field.wrap() ? at + reach : std::min(at + reach, edge);
  };
  const double west = low(x, field.x_min());
  const double east = high(x, field.x_max());
  const double south = low(y, field.y_min());
  const double north = high(y, field.y_max());
  return {(field.at(east, y).height - field.at(west, y).height) / (east - west),
          (field.at(x, north).height - field.at(x, south).height) / (north - south)};
}

Color shaded(Color color, double brightness, double strength) {
  const double factor = 1.0 + strength * (brightness - 1.0);
  return {color.red * factor, color.green * factor, color.blue * factor};
}

/// How much of a pixel a contour line covers, 0..1, for lines at multiples of `interval`.
double contour_cover(double height, const Relief& slope, double interval, double metres_per_pixel) {
  constexpr double kHalfWidth_px = 0.5;
  const double rise_per_pixel = std::hypot(slope.x, slope.y) * metres_per_pixel;
  if (rise_per_pixel < 1e-4 * interval) return 0.0;  // level ground is no line
  const double distance_px =
      std::abs(height - std::round(height / interval) * interval) / rise_per_pixel;
  return std::clamp(kHalfWidth_px + 0.5 - distance_px, 0.0, 1.0);
}

/// Calls color(x, y) for the middle of every pixel of the map and paints it.
template <typename ColorAt>
void paint_map(Canvas& canvas, const MapFrame& frame, const ColorAt& color) {
  const PixelBox& map = frame.map();
  const int left = static_cast<int>(map.left);
  const int top = static_cast<int>(map.top);
  std::vector<Color> colors(static_cast<size_t>(map.width));
  for (int row = top; row < top + static_cast<int>(map.height); ++row) {
    const double y = frame.y_at(row + 0.5);
    double pixel_x = left + 0.5;
    for (Color& target : colors) {
      target = color(frame.x_at(pixel_x), y);
      pixel_x += 1.0;
    }
    canvas.set_row(left, row, colors);
  }
}

std::string millimetres(double metres) {
  return number_text(metres * kMillimetres, 0);
}

std::string figures(const HeightField& field, const TerrainStatistics& s) {
  return number_text(field.x_max() - field.x_min(), 2) + " \u00d7 " +
         number_text(field.y_max() - field.y_min(), 2) + " m,  height range " +
         millimetres(s.highest_m - s.lowest_m) + " mm,  slope: mean " +
         number_text(s.mean_slope_deg, 1) + "\u00b0, 95 % below " +
         number_text(s.p95_slope_deg, 1) + "\u00b0, steepest " +
         number_text(s.steepest_slope_deg, 1) + "\u00b0";
}

/// Volumes in litres.
std::string figures(const TerrainChange& change) {
  constexpr double kLitresPerCubicMetre = 1000.0;
  const auto litres = [](double m3) { return number_text(m3 * kLitresPerCubicMetre, 3) + " L"; };
  const auto depth = [](double m) { return number_text(m * kMillimetres, 1) + " mm"; };
  return "moved " + litres(change.moved_m3()) + ",  cut " + litres(change.cut_m3) + ", up to " +
         depth(change.deepest_cut_m) + " deep,  fill " + litres(change.fill_m3) + ", up to " +
         depth(change.deepest_fill_m) + " high";
}

/// The colours and contour lines of a height map.
struct HeightScale {
  double low_m;
  double high_m;
  Ticks contours;

  [[nodiscard]] Color color(double height_m) const {
    return height_color((height_m - low_m) / (high_m - low_m));
  }
};

HeightScale height_scale(const HeightRange& range) {
  constexpr double kMinRange_m = 0.001;  // level ground still gets a colour bar
  constexpr int kMaxContours = 14;
  const double high = std::max(range.high_m, range.low_m + kMinRange_m);
  return {range.low_m, high, round_ticks(range.low_m, high, kMaxContours)};
}

HeightScale height_scale(const TerrainStatistics& s, const PictureOptions& options) {
  return height_scale(options.heights.value_or(HeightRange{s.lowest_m, s.highest_m}));
}

/// The ground at a place, with light and contour lines.
Color height_map_color(const HeightField& field, const HeightScale& heights, double x, double y,
                       double metres_per_pixel) {
  constexpr double kExaggeration = 1.6;
  constexpr double kShadeStrength = 0.75;
  constexpr double kContourStrength = 0.22;
  const double height = field.at(x, y).height;
  const Relief slope = smooth_gradient(field, x, y);
  const double ink =
      kContourStrength * contour_cover(height, slope, heights.contours.step, metres_per_pixel);
  return shaded(heights.color(height), light(slope, kExaggeration) * (1.0 - ink), kShadeStrength);
}

ColorScale color_scale(const HeightScale& heights) {
  return {heights.low_m * kMillimetres, heights.high_m * kMillimetres, "height (mm)",
          [heights](double mm) { return heights.color(mm / kMillimetres); }};
}

std::string subtitle_of(const HeightField& field, const TerrainStatistics& s,
                        const HeightScale& scale, const PictureOptions& options) {
  std::string line = options.subtitle.empty() ? figures(field, s) : options.subtitle;
  const Ticks& contours = scale.contours;
  const double first_line = std::ceil(s.lowest_m / contours.step) * contours.step;
  if (first_line >= s.highest_m) return line;
  constexpr int kDecimalsOfMillimetres = 3;
  return line + ",  contours every " +
         number_text(contours.step * kMillimetres,
                     std::max(0, contours.decimals - kDecimalsOfMillimetres)) +
         " mm";
}

MapRectangle ground_of(const HeightField& field) {
  return {field.x_min(), field.x_max(), field.y_min(), field.y_max()};
}

void finish(Canvas& canvas, MapFrame& frame, const ColorScale& scale, BedEdge edge,
            const std::string& subtitle, const PictureOptions& options) {
  draw_path_overlay(canvas, frame, edge == BedEdge::kWrapped, options);
  frame.draw_title(options.title, subtitle);
  if (edge == BedEdge::kWalled) frame.draw_walls();
  frame.draw_axes();
  frame.draw_color_bar(scale);
  frame.draw_scale_bar();
  draw_legend(canvas, frame, options);
}

}  // namespace

HeightRange common_range(const HeightField& one, const HeightField& other) {
  const TerrainStatistics first = terrain_statistics(one);
  const TerrainStatistics second = terrain_statistics(other);
  return {std::min(first.lowest_m, second.lowest_m), std::max(first.highest_m, second.highest_m)};
}

std::string height_map_subtitle(const HeightField& field, const PictureOptions& options) {
  check(options);
  const TerrainStatistics statistics = terrain_statistics(field);
  return subtitle_of(field, statistics, height_scale(statistics, options), options);
}

Canvas draw_height_map(const HeightField& field, const PictureOptions& options) {
  check(options);
  Canvas canvas(options.width_px, options.height_px, kPaper);
  MapFrame frame(canvas, ground_of(field), legend_height_px(options));

  const TerrainStatistics statistics = terrain_statistics(field);
  const HeightScale heights = height_scale(statistics, options);
  const double metres_per_pixel = 1.0 / frame.pixels_per_metre();
  paint_map(canvas, frame, [&](double x, double y) {
    return height_map_color(field, heights, x, y, metres_per_pixel);
  });
  finish(canvas, frame, color_scale(heights), field.edge(),
         subtitle_of(field, statistics, heights, options), options);
  return canvas;
}

MapImage height_map_image(const HeightField& field, const HeightRange& range, int side_px) {
  require_side("side_px", side_px, 1);
  MapImage image{ground_of(field), 0, 0, {}};
  const double width_m = image.ground.x_max - image.ground.x_min;
  const double height_m = image.ground.y_max - image.ground.y_min;
  const double metres_per_pixel = std::max(width_m, height_m) / side_px;
  image.width = std::max(1, static_cast<int>(std::lround(width_m / metres_per_pixel)));
  image.height = std::max(1, static_cast<int>(std::lround(height_m / metres_per_pixel)));
  image.rgb.reserve(std::size_t{3} * static_cast<std::size_t>(image.width) *
                    static_cast<std::size_t>(image.height));
  const HeightScale heights = height_scale(range);
  for (int row = 0; row < image.height; ++row) {
    const double y = image.ground.y_max - (row + 0.5) * height_m / image.height;
    for (int column = 0; column < image.width; ++column) {
      const double x = image.ground.x_min + (column + 0.5) * width_m / image.width;
      const Color color = height_map_color(field, heights, x, y, metres_per_pixel);
      for (const double part : {color.red, color.green, color.blue}) {
        image.rgb.push_back(
            static_cast<std::uint8_t>(std::lround(std::clamp(part, 0.0, 1.0) * 255.0)));
      }
    }
  }
  return image;
}

ColorScale height_color_scale(const HeightRange& heights) {
  return color_scale(height_scale(heights));
}

Canvas draw_difference(const HeightField& before, const HeightField& after,
                       const PictureOptions& options) {
  check(options);
  const TerrainChange change = terrain_change(before, after);
  Canvas canvas(options.width_px, options.height_px, kPaper);
  MapFrame frame(canvas, ground_of(after), legend_height_px(options));

  constexpr double kMinChange_m = 0.0005;  // no change still gets a colour bar
  double largest = std::max({kMinChange_m, change.deepest_cut_m, change.deepest_fill_m});
  const double step = round_ticks(0.0, largest, 5).step;
  largest = std::ceil(largest / step) * step;  // the colour bar ends on a round number

  paint_map(canvas, frame, [&](double x, double y) {
    constexpr double kExaggeration = 1.2;
    constexpr double kShadeStrength = 0.3;
    const double rise = after.at(x, y).height - before.at(x, y).height;
    return shaded(difference_color(rise / largest),
                  light(smooth_gradient(after, x, y), kExaggeration), kShadeStrength);
  });
  const ColorScale scale{-largest * kMillimetres, largest * kMillimetres, "change of height (mm)",
                         [&](double mm) { return difference_color(mm / kMillimetres / largest); }};
  finish(canvas, frame, scale, after.edge(),
         options.subtitle.empty() ? figures(change) : options.subtitle, options);
  return canvas;
}

void write_height_map_picture(const std::filesystem::path& path, const HeightField& field,
                              const PictureOptions& options) {
  draw_height_map(field, options).write_png(path);
}

void write_difference_picture(const std::filesystem::path& path, const HeightField& before,
                              const HeightField& after, const PictureOptions& options) {
  draw_difference(before, after, options).write_png(path);
}

}  // namespace screed
