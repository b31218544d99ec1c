// Painting nodes, fitting and zooming, pixels.
#include "tools/screed/viewer/ground_view.h"

#include <algorithm>
#include <cmath>
#include <vector>

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

void Camera::fit(const MapRectangle& ground) {
  constexpr double kFilled = 0.94;
  const double width = ground.x_max - ground.x_min;
  const double depth = ground.y_max - ground.y_min;
  scale_ =
      std::clamp(kFilled * std::min(box_.width / width, box_.height / depth), kMinScale, kMaxScale);
  look_at(0.5 * (ground.x_min + ground.x_max), 0.5 * (ground.y_min + ground.y_max));
}

void Camera::zoom(double factor, Pixel fixed) {
  const double x = x_at(fixed.x);
  const double y = y_at(fixed.y);
  scale_ = std::clamp(scale_ * factor, kMinScale, kMaxScale);
  x_ = x - (fixed.x - middle().x) / scale_;
  y_ = y + (fixed.y - middle().y) / scale_;
}

namespace {

constexpr uint32_t kRedBlue = 0x00FF00FF;
constexpr uint32_t kGreen = 0x0000FF00;

/// From a to b by part / 256.
uint32_t mixed(uint32_t a, uint32_t b, uint32_t part) {
  const uint32_t red_blue = ((a & kRedBlue) * (256U - part) + (b & kRedBlue) * part) >> 8U;
  const uint32_t green = ((a & kGreen) * (256U - part) + (b & kGreen) * part) >> 8U;
  return (red_blue & kRedBlue) | (green & kGreen);
}

uint32_t darker(uint32_t color) {
  return ((color & 0x00FEFEFEU) >> 1U) + ((color & 0x00F8F8F8U) >> 3U);
}

/// Where a row or column of pixels lies between nodes.
struct Between {
  int low;
  int high;
  uint32_t part;  ///< of 256, towards high
  bool bed;       ///< on the bed itself, not beyond it or on one of its copies
  bool ground;    ///< there is something to be seen
};

Between between(double node, int nodes, bool wrap) {
  const double last = wrap ? nodes : nodes - 1;
  const bool bed = node >= 0.0 && node <= last;
  if (!bed && !wrap) return {0, 0, 0, false, false};
  const double within = wrap ? node - std::floor(node / nodes) * nodes : node;
  int low = std::min(static_cast<int>(within), nodes - 1);
  const auto part = static_cast<uint32_t>((within - low) * 256.0);
  if (!wrap && low == nodes - 1) return {low, low, 0, bed, true};
  const int high = low + 1 == nodes ? 0 : low + 1;
  return {low, high, std::min(part, 255U), bed, true};
}

}  // namespace

void draw_terrain(const PixelBuffer& buffer, const Camera& camera, const TerrainImage& image,
                  const TerrainPlacement& place, uint32_t beyond) {
  const PixelBox& box = camera.box();
  const int left = static_cast<int>(box.left);
  const int top = static_cast<int>(box.top);
  const auto width = static_cast<size_t>(box.width);
  const auto nodes_x = static_cast<size_t>(image.width());
  std::vector<Between> columns(width);
  for (size_t i = 0; i < width; ++i) {
    const double x = camera.x_at(left + static_cast<double>(i) + 0.5);
    columns[i] = between((x - place.x_min_m) / place.spacing_m, image.width(), place.wrap);
  }
  const uint32_t* nodes = image.pixels().data();
  for (int y = top; y < top + static_cast<int>(box.height); ++y) {
    uint32_t* target = buffer.pixels.data() +
                       static_cast<size_t>(y) * static_cast<size_t>(buffer.width) +
                       static_cast<size_t>(left);
    const Between row = between((camera.y_at(y + 0.5) - place.y_min_m) / place.spacing_m,
                                image.height(), place.wrap);
    if (!row.ground) {
      std::fill_n(target, width, beyond);
      continue;
    }
    const uint32_t* south = nodes + static_cast<size_t>(row.low) * nodes_x;
    const uint32_t* north = nodes + static_cast<size_t>(row.high) * nodes_x;
    for (const Between& column : columns) {
      if (!column.ground) {
        *target++ = beyond;
        continue;
      }
      const uint32_t below = mixed(south[column.low], south[column.high], column.part);
      const uint32_t above = mixed(north[column.low], north[column.high], column.part);
      const uint32_t color = mixed(below, above, row.part);
      *target++ = row.bed && column.bed ? color : darker(color);
    }
  }
}

void draw_stroke(const PixelBuffer& buffer, const PixelBox& box, Pixel from, Pixel to,
                 double width_px, uint32_t color) {
  const double reach = 0.5 * width_px + 1.0;
  const auto low = [&](double a, double b, double edge) {
    return static_cast<int>(std::max(std::floor(std::min(a, b) - reach), edge));
  };
  const auto high = [&](double a, double b, double edge) {
    return static_cast<int>(std::min(std::ceil(std::max(a, b) + reach), edge));
  };
  const int left = low(from.x, to.x, box.left);
  const int right = high(from.x, to.x, box.left + box.width);
  const int top = low(from.y, to.y, box.top);
  const int bottom = high(from.y, to.y, box.top + box.height);
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double length_squared = dx * dx + dy * dy;
  const double scale = length_squared > 0.0 ? 1.0 / length_squared : 0.0;
  for (int y = top; y < bottom; ++y) {
    uint32_t* row =
        buffer.pixels.data() + static_cast<size_t>(y) * static_cast<size_t>(buffer.width);
    const double py = y + 0.5 - from.y;
    for (int x = left; x < right; ++x) {
      const double px = x + 0.5 - from.x;
      const double along = std::clamp((px * dx + py * dy) * scale, 0.0, 1.0);
      const double across = std::hypot(px - along * dx, py - along * dy);
      const double cover = std::clamp(0.5 * width_px + 0.5 - across, 0.0, 1.0);
      if (cover <= 0.0) continue;
      row[x] = mixed(row[x], color, static_cast<uint32_t>(cover * 256.0));
    }
  }
}

}  // namespace screed::viewer
