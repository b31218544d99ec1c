// Painting nodes.
#include "tools/screed/viewer/terrain_image.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/constants.h"
#include "host_sim/render/picture/ground_painter.h"

namespace screed::viewer {
namespace {

constexpr double kSteepest_deg = 30.0;  // end of the scale of slopes
constexpr double kMinRelief_m = 0.02;   // level ground has a scale as well
// Ends of the scale of changes: the first one that holds them all.
constexpr std::array<double, 10> kChangeScales_m = {0.002, 0.005, 0.01, 0.02, 0.05,
                                                    0.1,   0.2,   0.5,  1.0,  10.0};
// Of the relief under the light: gentle hills are to be seen, gravel is not to be all shadow.
constexpr double kMaxExaggeration = 1.8;
constexpr double kLitGradient = 0.45;  // mean rise over run as it is lit, at most
constexpr std::array<double, kShadings> kShadeStrength = {0.8, 0.45, 0.4};
// Of level ground: pale colours leave room for the sunny side of a slope.
constexpr std::array<double, kShadings> kBrightness = {1.0, 0.97, 0.88};

uint32_t packed(const Color& color, double brightness) {
  const auto channel = [&](double value) {
    return static_cast<uint32_t>(std::clamp(value * brightness * 255.0 + 0.5, 0.0, 255.0));
  };
  return channel(color.red) << 16U | channel(color.green) << 8U | channel(color.blue);
}

}  // namespace

TerrainImage::TerrainImage(const HeightField& field, const HeightField& before)
    : nx_(field.nx()), ny_(field.ny()), wrap_(field.wrap()), change_m_(kChangeScales_m.front()) {
  const size_t nodes = static_cast<size_t>(nx_) * static_cast<size_t>(ny_);
  before_.reserve(nodes);
  for (size_t i = 0; i < nodes; ++i) before_.push_back(before.node(i));
  pixels_.resize(nodes);
  waits_.resize(nodes);
  const auto [low, high] = std::minmax_element(before_.begin(), before_.end());
  low_m_ = *low * kHeightUnit_m;
  high_m_ = *high * kHeightUnit_m;
  const double spare = std::max(0.0, 0.5 * (kMinRelief_m - (high_m_ - low_m_)));
  low_m_ -= spare;
  high_m_ += spare;
  double rises = 0.0;
  for (size_t i = 0; i + 1 < nodes; ++i) {
    rises += std::abs(static_cast<double>(before_[i + 1]) - before_[i]);
  }
  const double gradient = rises / static_cast<double>(nodes) * kHeightUnit_m / field.spacing_m();
  exaggeration_ =
      kMaxExaggeration * gradient < kLitGradient ? kMaxExaggeration : kLitGradient / gradient;
  for (size_t shading = 0; shading < kShadings; ++shading) {
    for (size_t i = 0; i < kColors; ++i) {
      colors_[shading][i] =
          color(static_cast<Shading>(shading), static_cast<double>(i) / (kColors - 1));
    }
  }
  for (size_t i = 0; i < nodes; ++i) grow_scale(field, i);
}

bool TerrainImage::grow_scale(const HeightField& field, size_t node) {
  const double by_m =
      std::abs(static_cast<double>(field.node(node)) - before_[node]) * kHeightUnit_m;
  if (by_m <= change_m_) return false;
  change_m_ = *std::lower_bound(kChangeScales_m.begin(), kChangeScales_m.end() - 1, by_m);
  return true;
}

Color TerrainImage::color(Shading shading, double share) {
  switch (shading) {
    case Shading::kSlope:
      return slope_color(share);
    case Shading::kChange:
      return difference_color(2.0 * share - 1.0);
    case Shading::kHeight:
      break;
  }
  return height_color(share);
}

ShadingScale TerrainImage::scale(Shading shading) const {
  constexpr double kMillimetres = 1e3;
  switch (shading) {
    case Shading::kSlope:
      return {"slope", "degrees", 0.0, kSteepest_deg};
    case Shading::kChange:
      return {"change", "mm", -change_m_ * kMillimetres, change_m_ * kMillimetres};
    case Shading::kHeight:
      break;
  }
  return {"height", "mm", low_m_ * kMillimetres, high_m_ * kMillimetres};
}

void TerrainImage::mark(int ix, int iy) {
  if (wrap_) {
    ix = ix < 0 ? ix + nx_ : (ix >= nx_ ? ix - nx_ : ix);
    iy = iy < 0 ? iy + ny_ : (iy >= ny_ ? iy - ny_ : iy);
  } else if (ix < 0 || iy < 0 || ix >= nx_ || iy >= ny_) {
    return;
  }
  const size_t node = static_cast<size_t>(iy) * static_cast<size_t>(nx_) + static_cast<size_t>(ix);
  if (waits_[node] != 0) return;
  waits_[node] = 1;
  waiting_.push_back(static_cast<uint32_t>(node));
}

void TerrainImage::update(const HeightField& field, std::span<const HeightChange> changes) {
  for (const HeightChange& change : changes) {
    if (grow_scale(field, change.node)) all_waits_ = all_waits_ || shading_ == Shading::kChange;
    // Its own colour, and the light on its neighbours.
    const int ix = static_cast<int>(change.node % static_cast<uint32_t>(nx_));
    const int iy = static_cast<int>(change.node / static_cast<uint32_t>(nx_));
    mark(ix, iy);
    mark(ix - 1, iy);
    mark(ix + 1, iy);
    mark(ix, iy - 1);
    mark(ix, iy + 1);
  }
}

size_t TerrainImage::paint(const HeightField& field, Shading shading) {
  all_waits_ = all_waits_ || shading != shading_;
  shading_ = shading;
  size_t painted = waiting_.size();
  if (all_waits_) {
    painted = pixels_.size();
    for (int iy = 0; iy < ny_; ++iy) {
      for (int ix = 0; ix < nx_; ++ix) {
        pixels_[static_cast<size_t>(iy) * static_cast<size_t>(nx_) + static_cast<size_t>(ix)] =
            pixel_at(field, ix, iy, shading);
      }
    }
  } else {
    for (const uint32_t node : waiting_) {
      pixels_[node] = pixel_at(field, static_cast<int>(node % static_cast<uint32_t>(nx_)),
                               static_cast<int>(node / static_cast<uint32_t>(nx_)), shading);
    }
  }
  for (const uint32_t node : waiting_) waits_[node] = 0;
  waiting_.clear();
  all_waits_ = false;
  return painted;
}

uint32_t TerrainImage::pixel_at(const HeightField& field, int ix, int iy, Shading shading) const {
  const auto neighbour = [this](int at, int step, int nodes) {
    const int next = at + step;
    if (next >= 0 && next < nodes) return next;
    return wrap_ ? (next < 0 ? nodes - 1 : 0) : at;
  };
  const int west = neighbour(ix, -1, nx_);
  const int east = neighbour(ix, 1, nx_);
  const int south = neighbour(iy, -1, ny_);
  const int north = neighbour(iy, 1, ny_);
  const bool edge_x = !wrap_ && (ix == 0 || ix == nx_ - 1);
  const bool edge_y = !wrap_ && (iy == 0 || iy == ny_ - 1);
  const double per_step = kHeightUnit_m / field.spacing_m();
  const Relief relief{(static_cast<double>(field.node(east, iy)) - field.node(west, iy)) *
                          per_step * (edge_x ? 1.0 : 0.5),
                      (static_cast<double>(field.node(ix, north)) - field.node(ix, south)) *
                          per_step * (edge_y ? 1.0 : 0.5)};
  const Height height = field.node(ix, iy);
  double share = 0.0;
  switch (shading) {
    case Shading::kHeight:
      share = (height * kHeightUnit_m - low_m_) / (high_m_ - low_m_);
      break;
    case Shading::kSlope:
      share = std::atan(std::hypot(relief.x, relief.y)) * kDegPerRad / kSteepest_deg;
      break;
    case Shading::kChange: {
      const size_t node =
          static_cast<size_t>(iy) * static_cast<size_t>(nx_) + static_cast<size_t>(ix);
      share = 0.5 + 0.5 * (static_cast<double>(height) - before_[node]) * kHeightUnit_m / change_m_;
      break;
    }
  }
  const auto index = static_cast<size_t>(
      std::lround(std::clamp(share, 0.0, 1.0) * static_cast<double>(kColors - 1)));
  const auto of_shading = static_cast<size_t>(shading);
  const double brightness =
      kBrightness[of_shading] *
      (1.0 + kShadeStrength[of_shading] * (light(relief, exaggeration_) - 1.0));
  return packed(colors_[of_shading][index], brightness);
}

}  // namespace screed::viewer
