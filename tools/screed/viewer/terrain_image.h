// The ground as coloured light and shade, a pixel a node; only what changed is painted again.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/run/session/session_layout.h"

namespace screed::viewer {

/// What the colours say. Light and shade of the relief are on all of them.
enum class Shading : uint8_t { kHeight, kSlope, kChange };
inline constexpr size_t kShadings = 3;

/// What is beside the colours of a shading.
struct ShadingScale {
  std::string label;
  std::string unit;
  double low = 0.0;
  double high = 0.0;
};

class TerrainImage {
 public:
  /// With the ground as it is; changes count from `before`, of the same grid, which also gives the
  /// scale of heights.
  TerrainImage(const HeightField& field, const HeightField& before);

  /// These heights of the field have changed.
  void update(const HeightField& field, std::span<const HeightChange> changes);
  /// Paints what is not up to date. Returns the number of pixels painted.
  size_t paint(const HeightField& field, Shading shading);

  /// 0x00RRGGBB, row by row from the south, a pixel a node, as paint() left them.
  const std::vector<uint32_t>& pixels() const { return pixels_; }
  int width() const { return nx_; }
  int height() const { return ny_; }
  ShadingScale scale(Shading shading) const;
  /// The colour of a value on level ground; `share` 0..1 from the scale's low to its high end.
  static Color color(Shading shading, double share);

 private:
  static constexpr size_t kColors = 1024;

  uint32_t pixel_at(const HeightField& field, int ix, int iy, Shading shading) const;
  /// Whether the scale of changes had to grow for this height.
  bool grow_scale(const HeightField& field, size_t node);
  void mark(int ix, int iy);

  int nx_;
  int ny_;
  bool wrap_;
  double low_m_;
  double high_m_;
  double change_m_;  // at the ends of the scale
  double exaggeration_;
  std::vector<Height> before_;
  std::vector<uint32_t> pixels_;
  std::vector<uint32_t> waiting_;  // nodes to be painted
  std::vector<uint8_t> waits_;     // of each node
  bool all_waits_ = true;
  Shading shading_ = Shading::kHeight;
  std::array<std::array<Color, kColors>, kShadings> colors_;
};

}  // namespace screed::viewer
