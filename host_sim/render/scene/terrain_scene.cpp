#include "host_sim/render/scene/terrain_scene.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/core/errors.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/map_frame.h"
#include "host_sim/render/scene/povray.h"

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

// Height fields, spheres, paths.

namespace {

constexpr double kTurned_m = 0.006;   // a change of height that counts as turned over entirely
constexpr double kBedFloor_m = 0.06;  // soil under the lowest place, where the bed is cut

int64_t wrapped(int64_t index, int64_t count) {
  const int64_t rest = index % count;
  return rest < 0 ? rest + count : rest;
}

/// Grains, lumps and two tones; `turned` names the image of what the robot has turned over.
std::string soil_texture(const TerrainSurface& ground, const TerrainFiles& files,
                         const SoilAppearance& look, const std::optional<HeightTint>& tint) {
  const auto tones = [&](double share) {
    const auto mix = [&](double tone) {
      const auto one = [&](double light, double dark) {
        return share * (tone * light + (1.0 - tone) * dark);
      };
      return pov_color({one(look.light.red, look.dark.red), one(look.light.green, look.dark.green),
                        one(look.light.blue, look.dark.blue), 1.0});
    };
    // Grains of a millimetre in patches of a hand.
    const std::string grains =
        "bozo scale 0.09 turbulence 0.6 pigment_map { "
        "[0.25 granite scale 0.011 color_map { [0.2 " +
        mix(0.75) + "] [0.6 " + mix(1.0) + "] [0.9 " + mix(0.45) +
        "] }] [0.8 granite scale 0.008 color_map { [0.2 " + mix(0.35) + "] [0.6 " + mix(0.7) +
        "] [0.9 " + mix(0.1) + "] }] }";
    return "pigment { " + tinted(grains, tint) + " }";
  };
  const std::string finish = " finish { ambient 0 diffuse 0.9 }";
  const auto grain = [](double strength) {
    return pov_line(
        " normal { average normal_map { [1.0 granite %.2f scale 0.006] [0.6 bumps %.2f scale "
        "0.003] } }",
        strength, strength);
  };
  std::string text = "#declare Firm = texture { " + tones(1.0) + grain(0.25) + finish + " }\n";
  if (files.change.empty()) return text + "#declare Soil = texture { Firm }\n";
  text += "#declare Turned = texture { " + tones(0.70) + grain(0.50) + finish + " }\n";
  // The image covers the unit square of x and y. What moves and stretches it onto the bed acts on
  // the textures in the map too, so they are moved the other way before.
  const std::string undo =
      pov_line(" translate <%.6f,%.6f,0> scale <%.8f,%.8f,1>", -ground.x_min(), -ground.y_min(),
               1.0 / ground.width_m(), 1.0 / ground.depth_m());
  return text + "#declare Soil = texture { image_pattern { png \"" + files.change +
         "\" gamma 1.0 interpolate 2" + (ground.wrap() ? "" : " once") +
         " } texture_map { [0.0 Firm" + undo + "] [1.0 Turned" + undo + "] }" +
         pov_line(" scale <%.6f,%.6f,1> translate <%.6f,%.6f,0> }\n", ground.width_m(),
                  ground.depth_m(), ground.x_min(), ground.y_min());
}

constexpr const char* kTable =
    "plane { z, %.5f texture { pigment { srgb <0.80,0.81,0.82> } finish { ambient 0 diffuse 0.85 "
    "} "
    "} }\n";

}  // namespace

TerrainSurface::TerrainSurface(const HeightMap& map) : map_(map) {
  if (map.geometry.nx < 2 || map.geometry.ny < 2) {
    throw InputError("a height map of " + std::to_string(map.geometry.nx) + " x " +
                     std::to_string(map.geometry.ny) + " heights cannot be drawn");
  }
  const auto [lowest, highest] = std::minmax_element(map.heights.begin(), map.heights.end());
  lowest_m_ = *lowest * map.geometry.unit_m;
  highest_m_ = *highest * map.geometry.unit_m;
}

double TerrainSurface::width_m() const {
  return (map_.geometry.nx - (wrap() ? 0 : 1)) * map_.geometry.spacing_m;
}

double TerrainSurface::depth_m() const {
  return (map_.geometry.ny - (wrap() ? 0 : 1)) * map_.geometry.spacing_m;
}

double TerrainSurface::node_m(int64_t ix, int64_t iy) const {
  const int64_t nx = map_.geometry.nx;
  const int64_t ny = map_.geometry.ny;
  ix = wrap() ? wrapped(ix, nx) : std::clamp<int64_t>(ix, 0, nx - 1);
  iy = wrap() ? wrapped(iy, ny) : std::clamp<int64_t>(iy, 0, ny - 1);
  return map_.heights[static_cast<size_t>(iy * nx + ix)] * map_.geometry.unit_m;
}

double TerrainSurface::height_m(double x, double y) const {
  const double u = (x - x_min()) / map_.geometry.spacing_m;
  const double v = (y - y_min()) / map_.geometry.spacing_m;
  const double fu = std::floor(u);
  const double fv = std::floor(v);
  const auto ix = static_cast<int64_t>(fu);
  const auto iy = static_cast<int64_t>(fv);
  const double a = u - fu;
  const double b = v - fv;
  return (1 - b) * ((1 - a) * node_m(ix, iy) + a * node_m(ix + 1, iy)) +
         b * ((1 - a) * node_m(ix, iy + 1) + a * node_m(ix + 1, iy + 1));
}

SoilAppearance soil_appearance(const std::string& preset) {
  static constexpr SoilTones kHardGround{{0.64, 0.62, 0.58}, {0.45, 0.43, 0.40}};
  const SoilTones& tones = preset.empty() ? kHardGround : soil_tones(preset);
  const auto color = [](const std::array<double, 3>& rgb) { return Color{rgb[0], rgb[1], rgb[2]}; };
  return {color(tones.light), color(tones.dark)};
}

GreyRaster height_raster(const TerrainSurface& ground) {
  const HeightMapGeometry& geometry = ground.map().geometry;
  // One column and row more where the bed repeats: the image ends where it begins again.
  const int extra = ground.wrap() ? 1 : 0;
  GreyRaster raster;
  raster.width = static_cast<int>(geometry.nx) + extra;
  raster.height = static_cast<int>(geometry.ny) + extra;
  raster.samples.reserve(static_cast<size_t>(raster.width) * static_cast<size_t>(raster.height));
  const double range = std::max(ground.highest_m() - ground.lowest_m(), geometry.unit_m);
  for (int row = raster.height - 1; row >= 0; --row) {
    for (int column = 0; column < raster.width; ++column) {
      const auto ix = static_cast<size_t>(column) % geometry.nx;
      const auto iy = static_cast<size_t>(row) % geometry.ny;
      const double height = ground.map().heights[iy * geometry.nx + ix] * geometry.unit_m;
      raster.samples.push_back(
          static_cast<uint16_t>(std::lround((height - ground.lowest_m()) / range * 65535.0)));
    }
  }
  return raster;
}

GreyRaster change_raster(const TerrainSurface& ground, const HeightMap& before) {
  const HeightMap& now = ground.map();
  if (before.geometry.nx != now.geometry.nx || before.geometry.ny != now.geometry.ny) return {};
  GreyRaster raster;
  bool changed = false;
  for (size_t row = now.geometry.ny; row-- > 0;) {
    for (size_t column = 0; column < now.geometry.nx; ++column) {
      const size_t i = row * now.geometry.nx + column;
      const double change = std::abs(now.heights[i] * now.geometry.unit_m -
                                     before.heights[i] * before.geometry.unit_m);
      changed = changed || change > 0.0;
      raster.samples.push_back(
          static_cast<uint16_t>(std::lround(std::min(1.0, change / kTurned_m) * 65535.0)));
    }
  }
  if (!changed) return {};
  raster.width = static_cast<int>(now.geometry.nx);
  raster.height = static_cast<int>(now.geometry.ny);
  return raster;
}

std::string terrain_text(const TerrainSurface& ground, const TerrainFiles& files,
                         const SoilAppearance& look, const std::optional<HeightTint>& tint) {
  const double rise = std::max(ground.highest_m() - ground.lowest_m(), 1e-6);
  std::string text = soil_texture(ground, files, look, tint);
  // POV-Ray's height field fills the unit cube, y up: swapped to z up while it is scaled.
  text += "#declare Bed = height_field { png \"" + files.heights + "\" gamma 1.0 smooth" +
          pov_line(" matrix <%.6f,0,0, 0,0,%.8f, 0,%.6f,0, %.6f,%.6f,%.8f> }\n", ground.width_m(),
                   rise, ground.depth_m(), ground.x_min(), ground.y_min(), ground.lowest_m());
  if (ground.wrap()) {
    constexpr int kCopies = 3;  // a side; the horizon hides what would be further
    text += "union {\n";
    for (int i = -kCopies; i <= kCopies; ++i) {
      for (int j = -kCopies; j <= kCopies; ++j) {
        text += pov_line("  object { Bed translate <%.6f,%.6f,0> }\n", i * ground.width_m(),
                         j * ground.depth_m());
      }
    }
    return text + "  texture { Soil }\n}\n";
  }
  const double floor = ground.lowest_m() - kBedFloor_m;
  text += "object { Bed texture { Soil } }\n";
  // The cut through the soil at each edge.
  const auto wall = [&](bool along_x, double across) {
    const HeightMapGeometry& g = ground.map().geometry;
    const size_t count = along_x ? g.nx : g.ny;
    std::string vertices;
    std::string faces;
    for (size_t i = 0; i < count; ++i) {
      const double along =
          (along_x ? g.origin_x_m : g.origin_y_m) + static_cast<double>(i) * g.spacing_m;
      const double x = along_x ? along : across;
      const double y = along_x ? across : along;
      vertices +=
          ", " + pov_vector({x, y, floor}) + ", " + pov_vector({x, y, ground.height_m(x, y)});
      if (i > 0) {
        faces += pov_line(", <%zu,%zu,%zu>, <%zu,%zu,%zu>", 2 * i - 2, 2 * i - 1, 2 * i, 2 * i - 1,
                          2 * i + 1, 2 * i);
      }
    }
    return pov_line("mesh2 { vertex_vectors { %zu", 2 * count) + vertices +
           pov_line(" } face_indices { %zu", 2 * (count - 1)) + faces + " } texture { Firm } }\n";
  };
  text += wall(true, ground.y_min()) + wall(true, ground.y_min() + ground.depth_m()) +
          wall(false, ground.x_min()) + wall(false, ground.x_min() + ground.width_m());
  return text + pov_line(kTable, floor);
}

std::string walls_text(const TerrainSurface& ground) {
  const HeightMapGeometry& g = ground.map().geometry;
  if (!g.walls) return {};
  constexpr double kBoard_m = 0.018;
  constexpr double kAbove_m = 0.03;
  const double west = ground.x_min();
  const double south = ground.y_min();
  const double east = west + ground.width_m();
  const double north = south + ground.depth_m();
  const double floor = ground.lowest_m() - kBedFloor_m;
  const auto top_of = [&](bool along_x, double across) {
    double top = ground.lowest_m();
    for (size_t i = 0; i < (along_x ? g.nx : g.ny); ++i) {
      const double along = static_cast<double>(i) * g.spacing_m;
      top = std::max(top, along_x ? ground.height_m(west + along, across)
                                  : ground.height_m(across, south + along));
    }
    return top + kAbove_m;
  };
  const auto board = [&](const Eigen::Vector2d& low, const Eigen::Vector2d& high, double top) {
    return "  box { " + pov_vector({low.x(), low.y(), floor}) + ", " +
           pov_vector({high.x(), high.y(), top}) + " }\n";
  };
  return "union {\n" +
         board({west - kBoard_m, south - kBoard_m}, {east + kBoard_m, south}, top_of(true, south)) +
         board({west - kBoard_m, north}, {east + kBoard_m, north + kBoard_m}, top_of(true, north)) +
         board({west - kBoard_m, south}, {west, north}, top_of(false, west)) +
         board({east, south}, {east + kBoard_m, north}, top_of(false, east)) +
         "  texture { pigment { " + pov_color(kBoards) +
         " } finish { ambient 0 diffuse 0.85 } }\n}\n";
}

std::string path_text(std::span<const Eigen::Vector2d> path, const TerrainSurface& ground,
                      double radius_m) {
  constexpr double kJump_m = 0.2;
  const auto over = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector3d(p.x(), p.y(), ground.height_m(p.x(), p.y()) + 0.5 * radius_m);
  };
  std::string text;
  for (size_t i = 1; i < path.size(); ++i) {
    if ((path[i] - path[i - 1]).norm() > kJump_m) continue;
    const Eigen::Vector3d from = over(path[i - 1]);
    const Eigen::Vector3d to = over(path[i]);
    if ((to - from).norm() < 1e-4) continue;
    text += pov_line("cylinder { ") + pov_vector(from) + ", " + pov_vector(to) +
            pov_line(", %.4f } sphere { ", radius_m) + pov_vector(to) +
            pov_line(", %.4f }\n", radius_m);
  }
  if (text.empty()) return text;
  return "union {\n" + text +
         "  texture { pigment { srgb <0.12,0.42,0.72> } finish { ambient 0 diffuse 0.9 } }\n}\n";
}

}  // namespace screed
