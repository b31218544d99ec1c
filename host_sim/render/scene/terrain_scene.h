// The ground as part of a POV-Ray scene: a height field with the look of soil, or a bed of spheres,
// tinted by height where wanted, and the driven path. Knows height maps, no robots and no sessions.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/physics/terrain/height_map.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/scene/scene_camera.h"

namespace screed {

/// Colours by height (height_color()) that are mixed into what the terrain is made of.
struct HeightTint {
  double low_m = 0.0;   ///< dark slate at and below
  double high_m = 1.0;  ///< pale at and above; more than low_m
  double share = 0.5;   ///< of the tint in the colour, 0..1
};

/// From the round number of millimetres below `low_m` to the one above `high_m`.
HeightTint height_tint(double low_m, double high_m);

/// `#declare HeightColors`, before everything that is tinted.
std::string tint_text(const HeightTint& tint);

/// `pattern`, what stands between the braces of a POV-Ray pigment, with the tint mixed in; as it is
/// without a tint.
std::string tinted(const std::string& pattern, const std::optional<HeightTint>& tint);

/// The colour bar with its heights in mm, in the lower left corner of what the camera sees.
std::string tint_legend_text(const HeightTint& tint, const SceneCamera& camera,
                             const PictureFormat& format);

/// The surface of a height map at any place, metres: bilinear, its edges going on outwards, or
/// repeated.
class TerrainSurface {
 public:
  /// Throws InputError for a map of less than 2 x 2 heights.
  explicit TerrainSurface(const HeightMap& map);
  double height_m(double x, double y) const;

  double x_min() const { return map_.geometry.origin_x_m; }
  double y_min() const { return map_.geometry.origin_y_m; }
  /// Of the bed: with wrap-around up to where it repeats.
  double width_m() const;
  double depth_m() const;
  double lowest_m() const { return lowest_m_; }
  double highest_m() const { return highest_m_; }
  bool wrap() const { return map_.geometry.wrap; }
  const HeightMap& map() const { return map_; }

 private:
  double node_m(int64_t ix, int64_t iy) const;

  const HeightMap& map_;
  double lowest_m_;
  double highest_m_;
};

/// How soil looks: two tones that it varies between, and what has been turned over.
struct SoilAppearance {
  Color light;
  Color dark;
};
/// The look of a named soil (soil_parameters.h); "gravel" for particles, "" for hard ground.
SoilAppearance soil_appearance(const std::string& preset);

/// A grey image that the scene needs: 16 bits for heights.
struct GreyRaster {
  int width = 0;
  int height = 0;
  std::vector<uint16_t> samples;  ///< row 0 = north
};

/// The heights of the map as an image, black the lowest, white the highest.
GreyRaster height_raster(const TerrainSurface& ground);
/// How far the ground has changed between the maps, black: not at all, white: 6 mm or more. Empty
/// when nothing has changed or the grids differ.
GreyRaster change_raster(const TerrainSurface& ground, const HeightMap& before);

struct TerrainFiles {
  std::string heights;  ///< name of the height image
  std::string change;   ///< name of the change image; empty: none
};
/// The height field. With wrap-around it is repeated on all sides; otherwise the bed ends in a cut
/// through the soil, on a plane table.
std::string terrain_text(const TerrainSurface& ground, const TerrainFiles& files,
                         const SoilAppearance& look,
                         const std::optional<HeightTint>& tint = std::nullopt);

/// Boards along the edges of a bed with walls, as high on each side as its ground and a little
/// more: the walls of the simulation have no top. Empty for a bed without walls.
std::string walls_text(const TerrainSurface& ground);

/// A thin line over the ground along these places; it breaks where two of them are further apart
/// than the robot can drive between them.
std::string path_text(std::span<const Eigen::Vector2d> path, const TerrainSurface& ground,
                      double radius_m);

}  // namespace screed
