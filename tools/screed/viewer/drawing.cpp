// The ground with all that lies on it, and the timeline under it; the panel is in panel.cpp.
#include "tools/screed/viewer/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/screed/viewer/panel.h"
#include "tools/screed/viewer/style.h"

namespace screed::viewer {
namespace {

constexpr double kTimeline_px = 46.0;
constexpr double kTimelineMargin_px = 22.0;
constexpr double kTrailWidth_px = 3.2;
constexpr double kTrailCasing_px = 6.0;
constexpr double kTrailStep_px = 2.0;
constexpr double kLugPitch_m = 0.0115;  // of the tread
constexpr Color kGlass{0.07, 0.085, 0.10, 0.80};

PixelBox grown(const PixelBox& box, double by) {
  return {box.left - by, box.top - by, box.width + 2.0 * by, box.height + 2.0 * by};
}

}  // namespace

Drawing::Drawing(int width_px, int height_px)
    : canvas_(std::max(width_px, kMinWidth), std::max(height_px, kMinHeight), kBackground) {}

void Drawing::resize(int width_px, int height_px) {
  canvas_ = Canvas(std::max(width_px, kMinWidth), std::max(height_px, kMinHeight), kBackground);
  drawn_.reset();
}

PixelBox Drawing::terrain_box() const {
  return {0.0, 0.0, canvas_.width() - kPanelWidth_px, canvas_.height() - kTimeline_px};
}

PixelBox Drawing::timeline_box() const {
  const PixelBox ground = terrain_box();
  return {0.0, ground.height, ground.width, kTimeline_px};
}

double Drawing::share_at(double pixel_x) const {
  const double width = timeline_box().width - 2.0 * kTimelineMargin_px;
  return std::clamp((pixel_x - kTimelineMargin_px) / width, 0.0, 1.0);
}

void Drawing::draw(const Scene& scene) {
  {
    const PixelBuffer buffer{canvas_.pixels(), canvas_.width()};
    draw_terrain(buffer, scene.camera, *scene.ground, scene.place, packed(kBeyond));
    canvas_.release_pixels();
  }
  canvas_.clip(terrain_box());
  draw_bed_edge(scene);
  canvas_.unclip();
  if (scene.show_trail) draw_trail(scene);
  canvas_.clip(terrain_box());
  draw_robot(scene);
  draw_scale_bar(scene);
  draw_color_bar(scene);
  draw_badges(scene);
  if (scene.help != nullptr) draw_help(*scene.help);
  canvas_.unclip();
  draw_timeline(scene);
  if (!drawn_.has_value() || *drawn_ != scene.status) {
    draw_status_panel(canvas_, scene.status);
    drawn_ = scene.status;
  }
}

void Drawing::draw_bed_edge(const Scene& scene) {
  const Pixel a = scene.camera.to_pixel(scene.bed.x_min, scene.bed.y_max);
  const Pixel b = scene.camera.to_pixel(scene.bed.x_max, scene.bed.y_min);
  canvas_.rectangle_outline({a.x, a.y, b.x - a.x, b.y - a.y}, 1.5, {1.0, 1.0, 1.0, 0.35});
}

void Drawing::draw_trail(const Scene& scene) {
  const std::vector<TrailPoint>& trail = *scene.trail;
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
      const Pixel to =
          last ? scene.camera.to_pixel(scene.robot.x_m, scene.robot.y_m) : place(trail[i]);
      const double length = std::hypot(to.x - from.x, to.y - from.y);
      if (length < kTrailStep_px && !last && trail[i].state == state) continue;
      if (length < jump_px) piece(from, to, state);
      from = to;
      if (!last) state = trail[i].state;
    }
  };
  const uint32_t casing = packed(kCasing);
  along([&](Pixel from, Pixel to, uint8_t) {
    draw_stroke(buffer, box, from, to, kTrailCasing_px, casing);
  });
  along([&](Pixel from, Pixel to, uint8_t state) {
    draw_stroke(buffer, box, from, to, kTrailWidth_px, packed(state_color(state)));
  });
  const Pixel start = place(trail[0]);
  draw_stroke(buffer, box, start, start, 15.0, packed(kInk));
  draw_stroke(buffer, box, start, start, 11.0, packed(kCasing));
  canvas_.release_pixels();
}

void Drawing::draw_robot(const Scene& scene) {
  const double cosine = std::cos(scene.robot.heading_rad);
  const double sine = std::sin(scene.robot.heading_rad);
  const auto pixel = [&](double x, double y) {
    return scene.camera.to_pixel(scene.robot.x_m + cosine * x - sine * y,
                                 scene.robot.y_m + sine * x + cosine * y);
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
    const double travel =
        i < shape.left_gear ? scene.robot.travel_left_m : scene.robot.travel_right_m;
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
  canvas_.polygon(arrow, state_color(static_cast<uint8_t>(scene.status.leveling_state)));
  canvas_.polygon_outline(arrow, 1.0, kInk);
}

void Drawing::draw_scale_bar(const Scene& scene) {
  constexpr double kLongest_px = 180.0;
  const Ticks ticks = round_ticks(0.0, kLongest_px / scene.camera.scale(), 3);
  const double length_m = ticks.values.back();
  const double length = length_m * scene.camera.scale();
  const PixelBox ground = terrain_box();
  const double left = 30.0;
  const double base = ground.height - 30.0;
  const std::string words = length_m >= 1.0    ? number_text(length_m, 0) + " m"
                            : length_m >= 0.01 ? number_text(length_m * 100.0, 0) + " cm"
                                               : number_text(length_m * 1000.0, 0) + " mm";
  canvas_.rectangle({left - 14.0, base - 30.0, length + 28.0, 44.0}, kGlass);
  const std::array<Pixel, 4> bar = {
      {{left, base - 5.0}, {left, base}, {left + length, base}, {left + length, base - 5.0}}};
  canvas_.line(bar, 2.0, kPaleInk);
  canvas_.text({left + 0.5 * length, base - 10.0}, words,
               {.size_px = 13.0, .color = kPaleInk, .align = TextAlign::kCenter});
}

void Drawing::draw_color_bar(const Scene& scene) {
  constexpr double kBarHeight_px = 170.0;
  constexpr double kBarWidth_px = 14.0;
  const PixelBox ground = terrain_box();
  const ShadingScale scale = scene.ground->scale(scene.shading);
  const double left = ground.width - 78.0;
  const double top = ground.height - kBarHeight_px - 34.0;
  canvas_.rectangle({left - 14.0, top - 40.0, 78.0, kBarHeight_px + 60.0}, kGlass);
  canvas_.text({left - 4.0, top - 22.0}, scale.label, {.size_px = 13.0, .color = kPaleInk});
  canvas_.text({left - 4.0, top - 8.0}, scale.unit, {.size_px = 11.0, .color = kFaintInk});
  for (int i = 0; i < static_cast<int>(kBarHeight_px); ++i) {
    canvas_.rectangle({left, top + i, kBarWidth_px, 1.0},
                      TerrainImage::color(scene.shading, 1.0 - (i + 0.5) / kBarHeight_px));
  }
  for (const double value : round_ticks(scale.low, scale.high, 6).values) {
    const double y = top + kBarHeight_px * (scale.high - value) / (scale.high - scale.low);
    const std::array<Pixel, 2> tick = {{{left + kBarWidth_px, y}, {left + kBarWidth_px + 4.0, y}}};
    canvas_.line(tick, 1.0, kPaleInk);
    canvas_.text({left + kBarWidth_px + 8.0, y + 4.0},
                 number_text(value, round_ticks(scale.low, scale.high, 6).decimals),
                 {.size_px = 11.0, .color = kPaleInk});
  }
}

void Drawing::draw_badges(const Scene& scene) {
  double left = 16.0;
  for (const std::string& badge : scene.badges) {
    const TextStyle style{.size_px = 13.0, .color = kPaleInk, .bold = true};
    const double width = canvas_.text_width(badge, style);
    canvas_.rectangle({left, 16.0, width + 24.0, 28.0}, kGlass);
    canvas_.text({left + 12.0, 35.0}, badge, style);
    left += width + 34.0;
  }
}

void Drawing::draw_help(const std::vector<HelpLine>& help) {
  constexpr double kRow_px = 25.0;
  constexpr double kWidth_px = 560.0;
  constexpr double kKeys_px = 165.0;
  const PixelBox ground = terrain_box();
  const double height = kRow_px * static_cast<double>(help.size()) + 74.0;
  const PixelBox box{std::max(0.0, 0.5 * (ground.width - kWidth_px)),
                     std::max(0.0, 0.5 * (ground.height - height)), kWidth_px, height};
  canvas_.rectangle(grown(box, 1.0), {1.0, 1.0, 1.0, 0.25});
  canvas_.rectangle(box, {0.07, 0.085, 0.10, 0.95});
  double y = box.top + 38.0;
  canvas_.text({box.left + 28.0, y}, "Keys", {.size_px = 18.0, .color = kPaleInk, .bold = true});
  y += 34.0;
  for (const HelpLine& line : help) {
    canvas_.text({box.left + 28.0, y}, line.keys,
                 {.size_px = 14.0, .color = kAccent, .bold = true});
    canvas_.text({box.left + 28.0 + kKeys_px, y}, line.what, {.size_px = 14.0, .color = kPaleInk});
    y += kRow_px;
  }
}

void Drawing::draw_timeline(const Scene& scene) {
  const PixelBox box = timeline_box();
  canvas_.rectangle(box, kBackground);
  const double left = kTimelineMargin_px;
  const double width = box.width - 2.0 * kTimelineMargin_px;
  const double y = box.top + 16.0;
  const double duration = scene.status.duration_s;
  const double share = duration > 0.0 ? std::clamp(scene.status.time_s / duration, 0.0, 1.0) : 0.0;
  canvas_.line(std::array<Pixel, 2>{{{left, y}, {left + width, y}}}, 5.0, kTrack);
  if (share > 0.0) {
    canvas_.line(std::array<Pixel, 2>{{{left, y}, {left + share * width, y}}}, 5.0, kAccent);
  }
  if (scene.show_timeline) canvas_.circle({left + share * width, y}, 7.5, kPaleInk);
  const Ticks ticks = round_ticks(0.0, duration, 9);
  for (const double value : ticks.values) {
    canvas_.text({left + width * value / duration, box.top + 37.0},
                 number_text(value, ticks.decimals) + " s",
                 {.size_px = 11.0, .color = kFaintInk, .align = TextAlign::kCenter});
  }
}

}  // namespace screed::viewer
