#include "host_sim/render/scene/height_tint.h"

#include <algorithm>
#include <cmath>

#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/map_frame.h"
#include "host_sim/render/scene/pov_text.h"

namespace screed {
namespace {

constexpr double kMmPerM = 1000.0;

/// POV-Ray repeats a gradient after its length. The tint has the middle third of it, its ends have
/// the rest: no height is outside.
constexpr double kThird = 1.0 / 3.0;

std::string color_map_text() {
  constexpr int kSteps = 24;
  std::string text = "color_map { [0.0 " + pov_color(height_color(0.0)) + "]";
  for (int i = 0; i <= kSteps; ++i) {
    const double t = static_cast<double>(i) / kSteps;
    text += pov_line(" [%.5f ", kThird * (1.0 + t)) + pov_color(height_color(t)) + "]";
  }
  return text + " [1.0 " + pov_color(height_color(1.0)) + "] }";
}

/// Flat words in the plane of the picture, bright as they are.
std::string words_text(const std::string& words, double x, double y, double size,
                       const Color& color, bool centred) {
  const std::string object =
      "text { internal 2 \"" + words + "\" 0.01, 0 " + pov_line("scale <%.5f,%.5f,1>", size, size);
  const std::string look = " texture { pigment { " + pov_color(color) +
                           " } finish { ambient 0 diffuse 0 emission 1 } } no_shadow no_reflection";
  const std::string place = pov_line(" translate <%.5f,%.5f,0.002>", x, y);
  if (!centred) return object + look + place + " }\n";
  // The width of words is known to POV-Ray alone.
  return "#declare Words = " + object + look + " }\n" +
         "object { Words translate <-0.5*(min_extent(Words).x+max_extent(Words).x),0,0>" + place +
         " }\n";
}

}  // namespace

HeightTint height_tint(double low_m, double high_m) {
  const double low_mm = kMmPerM * low_m;
  const double high_mm = std::max(kMmPerM * high_m, low_mm + 1.0);
  constexpr int kTicks = 6;
  const Ticks ticks = round_ticks(low_mm, high_mm, kTicks);
  HeightTint tint;
  tint.low_m = std::floor(low_mm / ticks.step + 1e-9) * ticks.step / kMmPerM;
  tint.high_m = std::ceil(high_mm / ticks.step - 1e-9) * ticks.step / kMmPerM;
  return tint;
}

std::string tint_text(const HeightTint& tint) {
  const double range = tint.high_m - tint.low_m;
  return "#declare HeightColors = pigment { gradient z " + color_map_text() +
         pov_line(" scale %.6f translate <0,0,%.6f> }\n", range / kThird, tint.low_m - range);
}

std::string tinted(const std::string& pattern, const std::optional<HeightTint>& tint) {
  if (!tint.has_value()) return pattern;
  return pov_line("average pigment_map { [%.3f ", 1.0 - tint->share) + pattern +
         pov_line("] [%.3f HeightColors] }", tint->share);
}

std::string tint_legend_text(const HeightTint& tint, const SceneCamera& camera,
                             const PictureFormat& format) {
  // Near the camera, so that nothing stands before it; lengths in half widths of the picture.
  constexpr double kDepth_m = 0.1;
  constexpr double kLeft = -0.95;
  constexpr double kWidth = 0.5;
  constexpr double kBar = 0.028;
  constexpr double kText = 0.042;
  constexpr double kPad = 0.025;
  const double bottom = -1.0 / format.aspect + 0.06;
  const double bar_bottom = bottom + 1.7 * kText;

  std::string text = "union {\n";
  text += pov_line(
      "  box { <%.4f,%.4f,-0.002>, <%.4f,%.4f,-0.001> texture { pigment { srgbt "
      "<1,1,1,0.25> } finish { ambient 0 diffuse 0 emission 1 } } no_shadow }\n",
      kLeft - kPad, bottom - kPad, kLeft + kWidth + 2.5 * kPad, bar_bottom + kBar + 2.2 * kText);
  text += pov_line("  box { <%.4f,%.4f,0>, <%.4f,%.4f,0.001> ", kLeft, bar_bottom, kLeft + kWidth,
                   bar_bottom + kBar) +
          "texture { pigment { gradient x " + color_map_text() +
          pov_line(" scale %.5f translate <%.5f,0,0> } ", kWidth / kThird, kLeft - kWidth) +
          "finish { ambient 0 diffuse 0 emission 1 } } no_shadow }\n";
  const Color ink{0.10, 0.11, 0.12};
  text += words_text("height [mm]", kLeft, bar_bottom + kBar + 0.6 * kText, kText, ink, false);
  constexpr int kTicks = 4;
  const Ticks ticks = round_ticks(kMmPerM * tint.low_m, kMmPerM * tint.high_m, kTicks);
  for (const double tick : ticks.values) {
    const double x = kLeft + kWidth * (tick / kMmPerM - tint.low_m) / (tint.high_m - tint.low_m);
    text += pov_line("  box { <%.4f,%.4f,0>, <%.4f,%.4f,0.001> texture { pigment { ", x - 0.0015,
                     bar_bottom - 0.4 * kText, x + 0.0015, bar_bottom) +
            pov_color(ink) + " } finish { ambient 0 diffuse 0 emission 1 } } no_shadow }\n";
    char number[32];
    std::snprintf(number, sizeof number, "%.*f", ticks.decimals, tick);
    text += words_text(number, x, bottom, kText, ink, true);
  }
  constexpr double kRadPerDeg = 0.017453292519943295;
  const double scale = kDepth_m * std::tan(0.5 * format.field_of_view_deg * kRadPerDeg);
  return text + pov_line("  scale %.6f", scale) + pov_matrix(picture_pose(camera, kDepth_m)) +
         "\n}\n";
}

}  // namespace screed
