// Pictures of height fields: a shaded height map with a driven path and the robot, and what changed
// between two.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/ground_painter.h"
#include "host_sim/render/picture/map_frame.h"

namespace screed {

/// A rectangle in the robot's frame, m: x forward, y left.
struct RobotPlate {
  double back;
  double front;
  double right;
  double left;
};

struct RobotShape {
  RobotPlate hull{};
  std::vector<RobotPlate> running_gear;  ///< tracks, or wheels: those of the left side first
  size_t left_gear = 0;                  ///< how many of them are on the left
};

/// tracks: tracks round the wheels.
RobotShape shape_of(const Assembly& robot, bool tracks);

/// A plate with its lower and upper face, m in the robot's frame.
struct RobotBox {
  RobotPlate plate;
  double bottom;
  double top;
};

/// The same in three dimensions.
struct RobotBoxes {
  RobotBox hull;
  std::vector<RobotBox> running_gear;
};
RobotBoxes boxes_of(const Assembly& robot, bool tracks);

/// One place of a driven path; `state` colours the path from here to the next place
/// (state_color()) and indexes PictureOptions::state_names.
struct PathPoint {
  double x_m;
  double y_m;
  size_t state;
};

/// The robot from above: its origin, heading counter-clockwise from east, shape.
struct RobotOutline {
  double x_m;
  double y_m;
  double heading_rad;
  RobotShape shape;
};

/// Heights that the colours of a map span, m.
struct HeightRange {
  double low_m;
  double high_m;
};

/// A driven path and who drove it.
struct PictureRobot {
  std::vector<PathPoint> path;
  std::optional<RobotOutline> outline;
};

struct PictureOptions {
  int width_px = 1200;   ///< 800..8000
  int height_px = 1000;  ///< 700..8000
  std::string title;
  std::string subtitle;  ///< empty: a line of figures about the terrain
  /// Of a height map. Without it the map's own: pictures that are to be compared need the same.
  std::optional<HeightRange> heights;
  std::vector<PictureRobot> robots;
  bool paths_from_start = true;  ///< else their first points are no starts, and are not marked
  std::vector<std::string> state_names;  ///< of all states; the legend lists those of the paths
};

/// The heights of both.
HeightRange common_range(const HeightField& one, const HeightField& other);

/// The line under the title of a height map: options.subtitle or the figures of the field, and how
/// many mm the contour lines are apart, where there are any. Throws as draw_height_map().
std::string height_map_subtitle(const HeightField& field, const PictureOptions& options);

/// Draws heights in colour under light from the north-west, contour lines, axes in metres, a colour
/// bar in mm, and path, robot and legend where given. On wrapped terrain a path may jump by a bed.
/// Throws InputError for options out of range (a path's state without a name, a place or a height
/// that is no number, heights upside down).
/// A painter that is kept for several maps of one bed paints only what differs.
Canvas draw_height_map(const HeightField& field, const PictureOptions& options,
                       HeightPainter& painter);
Canvas draw_height_map(const HeightField& field, const PictureOptions& options);

/// The same map alone: heights in colour, light and contour lines. Its larger side has so many
/// pixels, 1 to 8000, else InputError.
MapImage height_map_image(const HeightField& field, const HeightRange& heights, int side_px,
                          HeightPainter& painter);

/// What the colours of such a map mean, mm.
ColorScale height_color_scale(const HeightRange& heights);

/// Draws after - before in diverging colours around 0, with the relief of `after` as a faint shade.
/// Both fields must have the same grid, else InputError. Otherwise as above.
Canvas draw_difference(const HeightField& before, const HeightField& after,
                       const PictureOptions& options);

/// The same as PNG files. Throw RunError as well, when the file cannot be written. Same input, same
/// bytes.
void write_height_map_picture(const std::filesystem::path& path, const HeightField& field,
                              const PictureOptions& options, HeightPainter& painter);
void write_difference_picture(const std::filesystem::path& path, const HeightField& before,
                              const HeightField& after, const PictureOptions& options);

}  // namespace screed
