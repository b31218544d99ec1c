// The ground with the robot and its path on it, and what lies over them: badges, scale bar,
// colours, keys, and the timeline below. The panel is in panel.cpp.
#include "tools/screed/viewer/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/path_overlay.h"
#include "tools/screed/viewer/layout.h"
#include "tools/screed/viewer/panel.h"

namespace screed::viewer {
namespace {

constexpr double kTrailWidth_px = 3.2;
constexpr double kTrailCasing_px = 6.0;
constexpr double kTrailStep_px = 2.0;
constexpr double kTrailEnd_px = 5.5;
constexpr double kLugPitch_m = 0.0115;  // of the tread
constexpr double kBoard_m = 0.018;      // thickness of a wall
constexpr double kMinBoard_px = 3.0;

/// Calls draw(robot), last for the one that the panel tells about.
template <class Draw>
void each_robot(const Scene& scene, Draw draw) {
  for (size_t i = 1; i <= scene.robots.size(); ++i) draw(scene.robots[i % scene.robots.size()]);
}

}  // namespace

Drawing::Drawing(int width_px, int height_px)
    : canvas_(std::max(width_px, kMinWindowWidth_px), std::max(height_px, kMinWindowHeight_px),
              kBackground),
      layout_(layout_of(canvas_.width(), canvas_.height())) {}

void Drawing::resize(int width_px, int height_px) {
  canvas_ = Canvas(std::max(width_px, kMinWindowWidth_px), std::max(height_px, kMinWindowHeight_px),
                   kBackground);
  layout_ = layout_of(canvas_.width(), canvas_.height());
  drawn_.reset();
}

double Drawing::share_at(double pixel_x) const {
  const TimelineBar bar = timeline_bar(layout_);
  return std::clamp((pixel_x - bar.left) / (bar.right - bar.left), 0.0, 1.0);
}

void Drawing::draw(const Scene& scene) {
  {
    const PixelBuffer buffer{canvas_.pixels(), canvas_.width()};
    draw_terrain(buffer, scene.camera, *scene.ground, scene.place, pixel_of(kBeyond));
    canvas_.release_pixels();
  }
  canvas_.clip(terrain_box());
  draw_bed_edge(scene);
  // Below the paths, whose ends they would hide.
  each_robot(scene, [&](const ShownRobot& it) { draw_robot(scene, it.robot, it.state); });
  canvas_.unclip();
  if (scene.show_trail) {
    each_robot(scene, [&](const ShownRobot& it) { draw_trail(scene, it.trail, it.robot); });
  }
  canvas_.clip(terrain_box());
  if (scene.show_trail) {
    each_robot(scene, [&](const ShownRobot& it) { draw_trail_ends(scene, it.trail, it.robot); });
  }
  draw_overlay(scene);
  canvas_.unclip();
  draw_timeline(scene);
  if (!drawn_.has_value() || *drawn_ != scene.status) {
    draw_status_panel(canvas_, layout_, scene.status);
    drawn_ = scene.status;
  }
  if (scene.help != nullptr) {
    draw_help(*scene.help);
    drawn_.reset();  // the help may lie over the panel
  }
}

void Drawing::draw_bed_edge(const Scene& scene) {
  const Pixel a = scene.camera.to_pixel(scene.bed.x_min, scene.bed.y_max);
  const Pixel b = scene.camera.to_pixel(scene.bed.x_max, scene.bed.y_min);
  canvas_.rectangle_outline({a.x, a.y, b.x - a.x, b.y - a.y}, 1.5, {1.0, 1.0, 1.0, 0.35});
  if (!scene.place.walls) return;
  const double board = std::max(kMinBoard_px, kBoard_m * scene.camera.scale());
  canvas_.rectangle_outline(
      {a.x - 0.5 * board, a.y - 0.5 * board, b.x - a.x + board, b.y - a.y + board}, board, kBoards);
}

void Drawing::draw_trail(const Scene& scene, const std::vector<TrailPoint>& trail,
                         const RobotMarker& robot) {
  const size_t count = std::min(scene.trail_points, trail.size());
  if (count == 0) return;
  const PixelBuffer buffer{canvas_.pixels(), canvas_.width()};
  const PixelBox box = terrain_box();
  const double jump_px =
      0.5 * std::min(scene.bed.x_max - scene.bed.x_min, scene.bed.y_max - scene.bed.y_min) *
      scene.camera.scale();
  const auto place = [&](const TrailPoint& point) {
    return scene.camera.to_pixel(point.x_m, point.y_m);
  };
  /// Calls piece(from, to, state) along the trail and to the robot, without what is too short to be
  /// seen.
  const auto along = [&](const auto& piece) {
    Pixel from = place(trail[0]);
    uint8_t state = trail[0].state;
    for (size_t i = 1; i <= count; ++i) {
      const bool last = i == count;
      const Pixel to = last ? scene.camera.to_pixel(robot.x_m, robot.y_m) : place(trail[i]);
      const double length = std::hypot(to.x - from.x, to.y - from.y);
      if (length < kTrailStep_px && !last && trail[i].state == state) continue;
      if (length < jump_px) piece(from, to, state);
      from = to;
      if (!last) state = trail[i].state;
    }
  };
  const uint32_t casing = pixel_of(kCasing);
  along([&](Pixel from, Pixel to, uint8_t) {
    draw_stroke(buffer, box, from, to, kTrailCasing_px, casing);
  });
  along([&](Pixel from, Pixel to, uint8_t state) {
    draw_stroke(buffer, box, from, to, kTrailWidth_px, pixel_of(state_color(state)));
  });
  canvas_.release_pixels();
}

void Drawing::draw_trail_ends(const Scene& scene, const std::vector<TrailPoint>& trail,
                              const RobotMarker& robot) {
  if (std::min(scene.trail_points, trail.size()) == 0) return;
  const double radius = kTrailEnd_px * layout_.scale;
  const TrailPoint& start = trail.front();
  draw_path_start(canvas_, scene.camera.to_pixel(start.x_m, start.y_m), radius);
  draw_path_end(canvas_, scene.camera.to_pixel(robot.x_m, robot.y_m), radius);
}

void Drawing::draw_robot(const Scene& scene, const RobotMarker& robot, uint8_t state) {
  const double cosine = std::cos(robot.heading_rad);
  const double sine = std::sin(robot.heading_rad);
  const auto pixel = [&](double x, double y) {
    return scene.camera.to_pixel(robot.x_m + cosine * x - sine * y,
                                 robot.y_m + sine * x + cosine * y);
  };
  const auto corners = [&](const RobotPlate& p, double by) {
    return std::array<Pixel, 4>{
        {pixel(p.back - by, p.right - by), pixel(p.front + by, p.right - by),
         pixel(p.front + by, p.left + by), pixel(p.back - by, p.left + by)}};
  };
  const RobotShape& shape = *scene.shape;
  const double line_m = 1.0 / scene.camera.scale();
  // A light rim, so that the robot stands out from dark ground.
  canvas_.polygon(corners(shape.hull, 2.5 * line_m), kCasing);
  for (const RobotPlate& gear : shape.running_gear) {
    canvas_.polygon(corners(gear, 2.5 * line_m), kCasing);
  }
  canvas_.polygon(corners(shape.hull, 0.0), kHull);
  canvas_.polygon_outline(corners(shape.hull, 0.0), 1.5, kInk);
  const bool lugs_are_seen = kLugPitch_m * scene.camera.scale() > 3.0;
  for (size_t i = 0; i < shape.running_gear.size(); ++i) {
    const RobotPlate& gear = shape.running_gear[i];
    canvas_.polygon(corners(gear, 0.0), kRubber);
    if (!lugs_are_seen) continue;
    const double travel = i < shape.left_gear ? robot.travel_left_m : robot.travel_right_m;
    // Seen from above is the upper run, which goes forward faster than the robot.
    const double first = std::fmod(travel, kLugPitch_m) + (travel < 0.0 ? kLugPitch_m : 0.0);
    const auto lugs = static_cast<int>((gear.front - 0.002 - gear.back - first) / kLugPitch_m) + 1;
    for (int lug_index = 0; lug_index < lugs; ++lug_index) {
      const double x = gear.back + first + lug_index * kLugPitch_m;
      const std::array<Pixel, 2> lug = {
          {pixel(x, gear.right + 0.004), pixel(x, gear.left - 0.004)}};
      canvas_.line(lug, std::max(1.0, 0.0028 * scene.camera.scale()), kLug);
    }
  }
  const RobotPlate& h = shape.hull;
  const double middle = 0.5 * (h.left + h.right);
  const double half = 0.34 * (h.left - h.right);
  const double nose = h.front - 0.12 * (h.front - h.back);
  const double tail = h.back + 0.22 * (h.front - h.back);
  const double notch = tail + 0.16 * (h.front - h.back);
  const std::array<Pixel, 4> arrow = {{pixel(nose, middle), pixel(tail, middle + half),
                                       pixel(notch, middle), pixel(tail, middle - half)}};
  canvas_.polygon(arrow, state_color(state));
  canvas_.polygon_outline(arrow, 1.0, kInk);
}

namespace {

constexpr Color kGlass{0.07, 0.085, 0.10, 0.80};

PixelBox grown(const PixelBox& box, double by) {
  return {box.left - by, box.top - by, box.width + 2.0 * by, box.height + 2.0 * by};
}

}  // namespace

Measure Drawing::measure() {
  return [this](const std::string& words, const TextStyle& style) {
    return canvas_.text_width(words, style);
  };
}

void Drawing::draw_text(const TextItem& text) {
  canvas_.text(text.anchor(), text.words, text.style);
}

void Drawing::draw_overlay(const Scene& scene) {
  const OverlayLayout overlay = overlay_layout(layout_, scene.badges, scene.camera.scale(),
                                               scene.ground->scale(scene.shading), measure());
  for (const OverlayLayout::Badge& badge : overlay.badges) {
    canvas_.rectangle(badge.box, kGlass);
    draw_text(badge.text);
  }

  canvas_.rectangle(overlay.scale_bar, kGlass);
  const double left = overlay.scale_bar_left;
  const double right = left + overlay.scale_bar_width;
  const double base = overlay.scale_bar_base;
  const std::array<Pixel, 4> bar = {
      {{left, base - 5.0}, {left, base}, {right, base}, {right, base - 5.0}}};
  canvas_.line(bar, 2.0, kPaleInk);
  draw_text(overlay.scale_bar_text);

  canvas_.rectangle(overlay.color_bar, kGlass);
  const PixelBox& ramp = overlay.color_ramp;
  for (int i = 0; i < static_cast<int>(ramp.height); ++i) {
    canvas_.rectangle({ramp.left, ramp.top + i, ramp.width, 1.0},
                      TerrainImage::color(scene.shading, 1.0 - (i + 0.5) / ramp.height));
  }
  for (const double y : overlay.color_ticks) {
    const double edge = ramp.left + ramp.width;
    canvas_.line(std::array<Pixel, 2>{{{edge, y}, {edge + 4.0 * layout_.scale, y}}}, 1.0, kPaleInk);
  }
  for (const TextItem& text : overlay.color_texts) draw_text(text);
}

void Drawing::draw_help(const std::vector<HelpLine>& lines) {
  const HelpLayout help = help_layout(layout_, lines, measure());
  canvas_.rectangle(grown(help.box, 1.0), {1.0, 1.0, 1.0, 0.25});
  canvas_.rectangle(help.box, {0.07, 0.085, 0.10});
  for (const TextItem& text : help.texts) draw_text(text);
}

void Drawing::draw_timeline(const Scene& scene) {
  canvas_.rectangle(layout_.timeline, kBackground);
  const TimelineBar bar = timeline_bar(layout_);
  const double duration = scene.status.duration_s;
  const double share = duration > 0.0 ? std::clamp(scene.status.time_s / duration, 0.0, 1.0) : 0.0;
  const double now = bar.left + share * (bar.right - bar.left);
  canvas_.line(std::array<Pixel, 2>{{{bar.left, bar.y}, {bar.right, bar.y}}}, 5.0, kTrack);
  if (share > 0.0) {
    canvas_.line(std::array<Pixel, 2>{{{bar.left, bar.y}, {now, bar.y}}}, 5.0, kAccent);
  }
  if (scene.show_timeline) canvas_.circle({now, bar.y}, 7.5 * layout_.scale, kPaleInk);
  for (const TextItem& text : timeline_texts(layout_, duration, measure())) draw_text(text);
}

}  // namespace screed::viewer
