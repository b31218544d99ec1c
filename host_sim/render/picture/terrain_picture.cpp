// Pictures of height fields on a canvas.
#include "host_sim/render/picture/terrain_picture.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/terrain_statistics.h"
#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/map_frame.h"
#include "host_sim/render/picture/path_overlay.h"

namespace screed {
namespace {

RobotPlate wheel_plate(const AssemblyWheel& wheel) {
  return {wheel.centre.x() - wheel.radius_m, wheel.centre.x() + wheel.radius_m,
          wheel.centre.y() - 0.5 * wheel.width_m, wheel.centre.y() + 0.5 * wheel.width_m};
}

RobotPlate around(const RobotPlate& a, const RobotPlate& b) {
  return {std::min(a.back, b.back), std::max(a.front, b.front), std::min(a.right, b.right),
          std::max(a.left, b.left)};
}

}  // namespace

RobotShape shape_of(const Assembly& robot, bool tracks) {
  RobotShape shape;
  for (const auto& side : robot.wheels) {
    const RobotPlate front = wheel_plate(side[0]);
    const RobotPlate rear = wheel_plate(side[1]);
    if (tracks) {
      shape.running_gear.push_back(around(front, rear));
    } else {
      shape.running_gear.push_back(front);
      shape.running_gear.push_back(rear);
    }
    if (shape.left_gear == 0) shape.left_gear = shape.running_gear.size();
  }
  // The hull fills the room between the sides, as long as the wheels' axles are apart and a little.
  RobotPlate all = shape.running_gear.front();
  for (const RobotPlate& gear : shape.running_gear) all = around(all, gear);
  const double wheel = robot.wheels[0][0].radius_m;
  const double width = shape.running_gear.front().left - shape.running_gear.front().right;
  shape.hull = {all.back + 0.4 * wheel, all.front - 0.4 * wheel, all.right + 0.7 * width,
                all.left - 0.7 * width};
  return shape;
}

RobotBoxes boxes_of(const Assembly& robot, bool tracks) {
  const RobotShape shape = shape_of(robot, tracks);
  const AssemblyWheel& wheel = robot.wheels[0][0];
  const double axle = wheel.centre.z();
  const double radius = wheel.radius_m;
  RobotBoxes boxes{{shape.hull, axle - 0.3 * radius, axle + 1.3 * radius}, {}};
  for (const RobotPlate& gear : shape.running_gear) {
    boxes.running_gear.push_back({gear, axle - radius, axle + radius});
  }
  return boxes;
}

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

void check_robot(const PictureOptions& options, const PictureRobot& robot) {
  for (const PathPoint& point : robot.path) {
    if (point.state >= options.state_names.size()) {
      throw InputError("picture: path state " + std::to_string(point.state) + " has no name; " +
                       std::to_string(options.state_names.size()) + " states are named");
    }
    require_finite("path point", {point.x_m, point.y_m});
  }
  if (const auto& outline = robot.outline)
    require_finite("robot outline", {outline->x_m, outline->y_m, outline->heading_rad});
}

void check(const PictureOptions& options) {
  require_side("width_px", options.width_px, 800);
  require_side("height_px", options.height_px, 700);
  if (options.state_names.size() > kStateColors) {
    throw InputError("picture: " + std::to_string(options.state_names.size()) +
                     " state names; allowed: at most " + std::to_string(kStateColors));
  }
  for (const PictureRobot& robot : options.robots) check_robot(options, robot);
  if (options.heights) {
    const HeightRange& heights = *options.heights;
    require_finite("range of heights", {heights.low_m, heights.high_m});
    if (heights.low_m > heights.high_m)
      throw InputError("picture: heights from " + std::to_string(heights.low_m) + " to " +
                       std::to_string(heights.high_m) + " m; allowed: the lower one first");
  }
}

/// The middles of the map's pixels.
PixelGrid grid_of(const MapFrame& frame) {
  const PixelBox& map = frame.map();
  PixelGrid grid;
  grid.metres_per_pixel = 1.0 / frame.pixels_per_metre();
  const auto columns = static_cast<int>(std::ceil(map.width - 0.5));
  const auto rows = static_cast<int>(std::ceil(map.height - 0.5));
  for (int i = 0; i < columns; ++i) grid.x_m.push_back(frame.x_at(map.left + 0.5 + i));
  for (int j = 0; j < rows; ++j) grid.y_m.push_back(frame.y_at(map.top + 0.5 + j));
  return grid;
}

void put_map(Canvas& canvas, const MapFrame& frame, std::span<const uint32_t> pixels) {
  const auto width = static_cast<size_t>(frame.map().width);
  int row = static_cast<int>(frame.map().top);
  for (; !pixels.empty(); pixels = pixels.subspan(width))
    canvas.set_row(static_cast<int>(frame.map().left), row++, pixels.first(width));
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

HeightColors height_scale(const HeightRange& range) {
  constexpr double kMinRange_m = 0.001;  // level ground still gets a colour bar
  constexpr int kMaxContours = 14;
  const double high = std::max(range.high_m, range.low_m + kMinRange_m);
  return {range.low_m, high, round_ticks(range.low_m, high, kMaxContours)};
}

HeightColors height_scale(const TerrainStatistics& s, const PictureOptions& options) {
  return height_scale(options.heights.value_or(HeightRange{s.lowest_m, s.highest_m}));
}

ColorScale color_scale(const HeightColors& heights) {
  return {heights.low_m * kMillimetres, heights.high_m * kMillimetres, "height [mm]",
          [heights](double mm) { return heights.color(mm / kMillimetres); }};
}

std::string subtitle_of(const HeightField& field, const TerrainStatistics& s,
                        const HeightColors& scale, const PictureOptions& options) {
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
  const auto nodes = [](const HeightField& field) {
    return std::span(field.heights(),
                     static_cast<size_t>(field.nx()) * static_cast<size_t>(field.ny()));
  };
  const auto [low, high] = std::ranges::minmax(nodes(one));
  const auto [other_low, other_high] = std::ranges::minmax(nodes(other));
  return {std::min(low, other_low) * kHeightUnit_m, std::max(high, other_high) * kHeightUnit_m};
}

std::string height_map_subtitle(const HeightField& field, const PictureOptions& options) {
  check(options);
  const TerrainStatistics statistics = terrain_statistics(field);
  return subtitle_of(field, statistics, height_scale(statistics, options), options);
}

Canvas draw_height_map(const HeightField& field, const PictureOptions& options,
                       HeightPainter& painter) {
  check(options);
  Canvas canvas(options.width_px, options.height_px, kPaper);
  MapFrame frame(canvas, ground_of(field), legend_height_px(options));

  const TerrainStatistics statistics = terrain_statistics(field);
  const HeightColors heights = height_scale(statistics, options);
  put_map(canvas, frame, painter.paint(field, grid_of(frame), heights));
  finish(canvas, frame, color_scale(heights), field.edge(),
         subtitle_of(field, statistics, heights, options), options);
  return canvas;
}

Canvas draw_height_map(const HeightField& field, const PictureOptions& options) {
  HeightPainter painter;
  return draw_height_map(field, options, painter);
}

MapImage height_map_image(const HeightField& field, const HeightRange& range, int side_px,
                          HeightPainter& painter) {
  require_side("side_px", side_px, 1);
  MapImage image{ground_of(field), 0, 0, {}};
  const double width_m = image.ground.x_max - image.ground.x_min;
  const double height_m = image.ground.y_max - image.ground.y_min;
  PixelGrid grid;
  grid.metres_per_pixel = std::max(width_m, height_m) / side_px;
  image.width = std::max(1, static_cast<int>(std::lround(width_m / grid.metres_per_pixel)));
  image.height = std::max(1, static_cast<int>(std::lround(height_m / grid.metres_per_pixel)));
  for (int column = 0; column < image.width; ++column)
    grid.x_m.push_back(image.ground.x_min + (column + 0.5) * width_m / image.width);
  for (int row = 0; row < image.height; ++row)
    grid.y_m.push_back(image.ground.y_max - (row + 0.5) * height_m / image.height);
  image.rgb = rgb_bytes(painter.paint(field, grid, height_scale(range)));
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

  put_map(canvas, frame, paint_difference(grid_of(frame), before, after, largest));
  const ColorScale scale{-largest * kMillimetres, largest * kMillimetres, "change of height [mm]",
                         [&](double mm) { return difference_color(mm / kMillimetres / largest); }};
  finish(canvas, frame, scale, after.edge(),
         options.subtitle.empty() ? figures(change) : options.subtitle, options);
  return canvas;
}

void write_height_map_picture(const std::filesystem::path& path, const HeightField& field,
                              const PictureOptions& options, HeightPainter& painter) {
  draw_height_map(field, options, painter).write_png(path);
}

void write_difference_picture(const std::filesystem::path& path, const HeightField& before,
                              const HeightField& after, const PictureOptions& options) {
  draw_difference(before, after, options).write_png(path);
}

}  // namespace screed
