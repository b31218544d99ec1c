// What lies over the ground: badges, scale bar, colours, keys; and the timeline below it.
#include <algorithm>
#include <array>

#include "tools/screed/viewer/drawing.h"
#include "tools/screed/viewer/style.h"

namespace screed::viewer {
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
