#include "host_sim/render/scene/sphere_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/render/scene/povray.h"

namespace screed {
namespace {

constexpr int kTones = 7;

/// The highest particle in each column of a grid over the bed, a diameter wide.
class ColumnTops {
 public:
  explicit ColumnTops(const SphereSet& particles) : width_m_(2.0 * particles.radius_m) {
    for (const auto& center : particles.centers_m) {
      x_min_ = std::min(x_min_, center[0]);
      y_min_ = std::min(y_min_, center[1]);
      x_max_ = std::max(x_max_, center[0]);
      y_max_ = std::max(y_max_, center[1]);
    }
    nx_ = column(x_max_, x_min_) + 1;
    ny_ = column(y_max_, y_min_) + 1;
    tops_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_), kNone);
    for (const auto& center : particles.centers_m) {
      float& top = tops_[index(column(center[0], x_min_), column(center[1], y_min_))];
      top = std::max(top, center[2]);
    }
  }

  /// The lowest of the tops round a particle; lower than everything at the edge of the bed.
  float lowest_near(const std::array<float, 3>& center) const {
    const int cx = column(center[0], x_min_);
    const int cy = column(center[1], y_min_);
    float lowest = std::numeric_limits<float>::infinity();
    for (int y = cy - 1; y <= cy + 1; ++y) {
      for (int x = cx - 1; x <= cx + 1; ++x) {
        if (x < 0 || y < 0 || x >= nx_ || y >= ny_) return kNone;
        lowest = std::min(lowest, tops_[index(x, y)]);
      }
    }
    return lowest;
  }

 private:
  static constexpr float kNone = -std::numeric_limits<float>::infinity();

  int column(float at, float from) const {
    return static_cast<int>((static_cast<double>(at) - static_cast<double>(from)) / width_m_);
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(nx_) +
           static_cast<std::size_t>(x);
  }

  double width_m_;
  float x_min_ = std::numeric_limits<float>::infinity();
  float y_min_ = std::numeric_limits<float>::infinity();
  float x_max_ = -std::numeric_limits<float>::infinity();
  float y_max_ = -std::numeric_limits<float>::infinity();
  int nx_ = 0;
  int ny_ = 0;
  std::vector<float> tops_;
};

/// Which tone a particle has: scattered over the bed, the same in every picture.
int tone_of(std::size_t particle) {
  std::uint32_t bits = static_cast<std::uint32_t>(particle) * 2654435761U;
  bits ^= bits >> 15U;
  return static_cast<int>(bits % kTones);
}

std::string tones_text(const SoilAppearance& look, const SphereSet& particles,
                       const std::optional<HeightTint>& tint) {
  std::string text;
  const double grain = 0.5 * particles.radius_m;
  for (int i = 0; i < kTones; ++i) {
    // Beyond light and dark: single stones differ more than the soil of which they are made.
    const double tone = -0.15 + 1.3 * i / (kTones - 1);
    const auto mixed = [&](double share) {
      const auto one = [&](double light, double dark) {
        return std::clamp(share * (tone * light + (1.0 - tone) * dark), 0.02, 0.95);
      };
      return pov_color({one(look.light.red, look.dark.red), one(look.light.green, look.dark.green),
                        one(look.light.blue, look.dark.blue), 1.0});
    };
    text += pov_line("#declare Stone%d = texture { pigment { ", i) +
            tinted(pov_line("granite scale %.5f color_map { [0.2 ", grain) + mixed(1.08) +
                       "] [0.8 " + mixed(0.88) + "] }",
                   tint) +
            " } finish { ambient 0 diffuse 0.88 specular 0.06 roughness 0.08 } }\n";
  }
  return text;
}

}  // namespace

std::vector<std::size_t> visible_spheres(const SphereSet& particles) {
  std::vector<std::size_t> visible;
  if (particles.centers_m.empty()) return visible;
  constexpr double kLayers = 2.5;
  const ColumnTops tops(particles);
  const auto deep = static_cast<float>(kLayers * 2.0 * particles.radius_m);
  for (std::size_t i = 0; i < particles.centers_m.size(); ++i) {
    const auto& center = particles.centers_m[i];
    if (center[2] > tops.lowest_near(center) - deep) visible.push_back(i);
  }
  return visible;
}

std::string spheres_text(const SphereSet& particles, const SoilAppearance& look,
                         const std::optional<HeightTint>& tint) {
  std::string text = tones_text(look, particles, tint);
  const std::vector<std::size_t> visible = visible_spheres(particles);
  text += "union {\n";
  for (const std::size_t i : visible) {
    const auto& center = particles.centers_m[i];
    text += pov_line("  sphere { <%.5f,%.5f,%.5f>, %.6f texture { Stone%d } }\n",
                     static_cast<double>(center[0]), static_cast<double>(center[1]),
                     static_cast<double>(center[2]), particles.radius_m, tone_of(i));
  }
  return text +
         "}\nplane { z, 0 texture { pigment { srgb <0.80,0.81,0.82> } finish { ambient 0 "
         "diffuse 0.85 } } }\n";
}

}  // namespace screed
