#include "host_sim/render/picture/path_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/render/picture/color_map.h"

namespace screed {
namespace {

constexpr Color kCasing{1.0, 1.0, 1.0, 0.92};
constexpr Color kPathInk{0.13, 0.15, 0.17};
constexpr Color kArrow{0.62, 0.65, 0.68};
constexpr double kPathWidth_px = 4.0;
constexpr double kCasingWidth_px = 7.5;
constexpr double kMarkerRadius_px = 8.0;
constexpr double kLegendRow_px = 27.0;

/// Path points first..last (inclusive) in one unbroken piece.
struct Piece {
  size_t first;
  size_t last;
};

bool jumps(const PathPoint& from, const PathPoint& to, const PixelBox& map, double scale) {
  return std::abs(to.x_m - from.x_m) * scale > 0.5 * map.width ||
         std::abs(to.y_m - from.y_m) * scale > 0.5 * map.height;
}

/// Splits where `splits(from, to)`; neighbours share their point unless they are apart.
template <typename Splits>
std::vector<Piece> pieces_of(const std::vector<PathPoint>& path, Piece whole, bool share,
                             const Splits& splits) {
  std::vector<Piece> pieces;
  size_t first = whole.first;
  for (size_t i = whole.first; i < whole.last; ++i) {
    if (!splits(path[i], path[i + 1])) continue;
    pieces.push_back({first, share ? i + 1 : i});
    first = i + 1;
  }
  pieces.push_back({first, whole.last});
  return pieces;
}

std::vector<Pixel> pixels_of(const MapFrame& frame, const std::vector<PathPoint>& path,
                             Piece piece) {
  std::vector<Pixel> pixels;
  for (size_t i = piece.first; i <= piece.last; ++i) {
    pixels.push_back(frame.to_pixel(path[i].x_m, path[i].y_m));
  }
  return pixels;
}

void draw_path(Canvas& canvas, const MapFrame& frame, bool wrap, bool from_start,
               const std::vector<PathPoint>& path) {
  if (path.empty()) return;
  const auto apart = [&](const PathPoint& from, const PathPoint& to) {
    return wrap && jumps(from, to, frame.map(), frame.pixels_per_metre());
  };
  const auto differ = [](const PathPoint& from, const PathPoint& to) {
    return from.state != to.state;
  };
  const std::vector<Piece> pieces = pieces_of(path, {0, path.size() - 1}, false, apart);
  // The light casing lies under all of the path, so that crossings stay clear.
  for (const Piece& piece : pieces) {
    canvas.line(pixels_of(frame, path, piece), kCasingWidth_px, kCasing);
  }
  for (const Piece& piece : pieces) {
    for (const Piece& run : pieces_of(path, piece, true, differ)) {
      canvas.line(pixels_of(frame, path, run), kPathWidth_px, state_color(path[run.first].state));
    }
  }
  if (from_start)
    draw_path_start(canvas, frame.to_pixel(path.front().x_m, path.front().y_m), kMarkerRadius_px);
  draw_path_end(canvas, frame.to_pixel(path.back().x_m, path.back().y_m), kMarkerRadius_px);
}

void draw_robot(Canvas& canvas, const MapFrame& frame, const RobotOutline& robot) {
  constexpr double kRim_px = 2.5;
  const double cosine = std::cos(robot.heading_rad);
  const double sine = std::sin(robot.heading_rad);
  const double rim_m = kRim_px / frame.pixels_per_metre();
  // Robot frame: x forward, y left.
  const auto pixel = [&](double x, double y) {
    return frame.to_pixel(robot.x_m + cosine * x - sine * y, robot.y_m + sine * x + cosine * y);
  };
  const auto corners = [&](const RobotPlate& plate, double by) {
    return std::array<Pixel, 4>{
        {pixel(plate.back - by, plate.right - by), pixel(plate.front + by, plate.right - by),
         pixel(plate.front + by, plate.left + by), pixel(plate.back - by, plate.left + by)}};
  };
  const RobotPlate& hull = robot.shape.hull;
  canvas.polygon(corners(hull, rim_m), kCasing);
  for (const RobotPlate& gear : robot.shape.running_gear) {
    canvas.polygon(corners(gear, rim_m), kCasing);
  }
  canvas.polygon(corners(hull, 0.0), {0.95, 0.96, 0.97});
  canvas.polygon_outline(corners(hull, 0.0), 1.5, kPathInk);
  for (const RobotPlate& gear : robot.shape.running_gear)
    canvas.polygon(corners(gear, 0.0), kPathInk);
  // As parts of half the hull's length and width.
  const auto on_hull = [&](double forward, double left) {
    return pixel(0.5 * ((hull.front + hull.back) + forward * (hull.front - hull.back)),
                 0.5 * ((hull.left + hull.right) + left * (hull.left - hull.right)));
  };
  const std::array<Pixel, 4> arrow = {
      {on_hull(0.74, 0.0), on_hull(-0.58, 0.74), on_hull(-0.28, 0.0), on_hull(-0.58, -0.74)}};
  canvas.polygon(arrow, kArrow);  // no state's colour
}

}  // namespace

void draw_path_start(Canvas& canvas, Pixel at, double radius_px) {
  canvas.circle(at, radius_px + 2.0, kPathInk);
  canvas.circle(at, radius_px, {1.0, 1.0, 1.0});
}

void draw_path_end(Canvas& canvas, Pixel at, double radius_px) {
  const auto square = [at](double half) {
    return PixelBox{at.x - half, at.y - half, 2.0 * half, 2.0 * half};
  };
  canvas.rectangle(square(radius_px + 0.5), {1.0, 1.0, 1.0});
  canvas.rectangle(square(radius_px - 1.5), kPathInk);
}

void draw_path_overlay(Canvas& canvas, const MapFrame& frame, bool wrap,
                       const PictureOptions& options) {
  canvas.clip(frame.map());
  // Below the paths, whose ends they would hide.
  for (const PictureRobot& robot : options.robots) {
    if (robot.outline) draw_robot(canvas, frame, *robot.outline);
  }
  for (const PictureRobot& robot : options.robots)
    draw_path(canvas, frame, wrap, options.paths_from_start, robot.path);
  canvas.unclip();
}

std::vector<size_t> states_on_paths(const PictureOptions& options) {
  std::vector<size_t> states;
  for (const PictureRobot& robot : options.robots) {
    for (const PathPoint& point : robot.path) {
      if (std::find(states.begin(), states.end(), point.state) == states.end())
        states.push_back(point.state);
    }
  }
  std::sort(states.begin(), states.end());
  return states;
}

double legend_height_px(const PictureOptions& options) {
  const size_t states = states_on_paths(options).size();
  if (states == 0) return 0.0;
  const size_t markers = options.paths_from_start ? 2 : 1;  // start and end
  return kLegendRow_px * static_cast<double>(1 + states + markers);
}

void draw_legend(Canvas& canvas, const MapFrame& frame, const PictureOptions& options) {
  if (states_on_paths(options).empty()) return;
  constexpr double kSample_px = 28.0;
  Pixel row = frame.legend();
  const auto name = [&](const std::string& text) {
    canvas.text({row.x + kSample_px + 12.0, row.y + 5.0}, text, {.color = kPathInk});
    row.y += kLegendRow_px;
  };
  canvas.text(row, "Driven path", {.color = kPathInk, .bold = true});
  row.y += kLegendRow_px;
  for (const size_t state : states_on_paths(options)) {
    canvas.line(std::array<Pixel, 2>{{{row.x + 2.0, row.y}, {row.x + kSample_px - 2.0, row.y}}},
                kPathWidth_px, state_color(state));
    name(options.state_names[state]);
  }
  if (options.paths_from_start) {
    draw_path_start(canvas, {row.x + 0.5 * kSample_px, row.y}, kMarkerRadius_px);
    name("start");
  }
  draw_path_end(canvas, {row.x + 0.5 * kSample_px, row.y}, kMarkerRadius_px);
  name("end");
}

}  // namespace screed
