// The lower surface of what presses on soil, in closed form: wheels, tracks, boxes and discs in any
// attitude.
//
// A footprint answers, for a vertical line at (x, y): does the body cross it, how low does it
// reach, and which way does its surface face there. A convex body's lowest point on the line is
// where the line, going up, enters it.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <vector>

#include "host_sim/physics/kernels/kernels.h"
#include "host_sim/physics/terrain/shear_field.h"

namespace screed {

/// A body's lower surface at many sample points at once, one array a property.
struct FootprintSamples {
  // Asked for:
  std::vector<double> x;
  std::vector<double> y;
  // Answered:
  std::vector<double> share;    ///< 0..1: how much of a small square at (x, y) the body covers
  std::vector<double> height;   ///< of the lower surface, m; what follows means nothing at share 0
  std::vector<double> slope_x;  ///< horizontal parts of the normal into the body, over its vertical
  std::vector<double> slope_y;
  std::vector<double> flat_within;  ///< the surface is plane at least this far around, m
  std::vector<double> passed;       ///< lowest height of the body over (x, y) on its path there, m

  /// Begins anew, with room for so many. Room is kept: allocates only when it was never as much.
  void clear(size_t room);
  void add(double at_x, double at_y) {
    x[count] = at_x;
    y[count] = at_y;
    ++count;
  }
  size_t count = 0;

  /// Fills up to whole blocks with the last point.
  void fill_block();
  /// For kernels, those from `first` on.
  SurfacePoints points(size_t first = 0) {
    return {x.data() + first,           y.data() + first,       share.data() + first,
            height.data() + first,      slope_x.data() + first, slope_y.data() + first,
            flat_within.data() + first, passed.data() + first};
  }
};

/// The path that a body came along, in its own axes.
struct PathHistory {
  double travel_m = 0.0;  ///< along local x, signed: it passed over no point that is further away
  double gradient = 0.0;  ///< displacement along local z over that along local x
  double back_m = 0.0;    ///< by how much it has come back from its furthest place, 0 or more
  double bend_rad = 0.0;  ///< its pitch now less the recent path's mean, positive nose down
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(travel_m, gradient, back_m, bend_rad);
  }
};

/// The face of a footprint that is below: its axes ahead, left and up in the world, and its
/// contour.
struct RunFrame {
  Eigen::Matrix3d axes;
  RunContour contour;
  double sense;  ///< 1: the surface of a belt that drives ahead goes backwards here; -1: ahead
  int face;      ///< which one it is
};

class Footprint {
 public:
  enum class Kind { kTrack, kBox, kDisc };

  /// A belt round two wheels, or with half_length 0 one wheel: a capsule in the local x-z plane,
  /// `width` along local y.
  static Footprint track(double half_length, double radius, double width);
  static Footprint wheel(double radius, double width) { return track(0.0, radius, width); }
  static Footprint box(const Eigen::Vector3d& size);
  /// A cylinder standing on its end, axis along local z.
  static Footprint disc(double radius, double thickness);

  void set_pose(const Eigen::Isometry3d& pose);
  const Eigen::Isometry3d& pose() const { return pose_; }

  Kind kind() const { return kind_; }
  /// Half extents in local axes; of a track half the distance of its axles, half its width, 0.
  const Eigen::Vector3d& half() const { return half_; }
  /// Of a track's wheels or a disc, m.
  double radius() const { return radius_; }

  /// Half of the extent in x and y of the world around pose().translation().
  Eigen::Vector2d reach() const;
  /// Half of the extent, along a level direction of unit length around pose().translation(), of
  /// what reaches below a level in the world's z, at least; negative when nothing does.
  double reach_below(double level, const Eigen::Vector2d& direction) const;
  /// Of a circle round pose().translation() that holds the body seen from above, m.
  double radius_from_above() const;
  /// Extent, along the body's y, of a world-aligned square of this side, m.
  double projected_side(double edge) const {
    return edge * (std::abs(pose_.linear()(0, 1)) + std::abs(pose_.linear()(1, 1)));
  }
  /// How far the body reaches down from pose().translation(), at most, m.
  double reach_down() const;
  /// Whether the touched area is a disc: then the b of Bekker's formula is its radius, else the
  /// shorter side of a rectangle.
  bool round() const { return kind_ == Kind::kDisc; }
  /// Whether two edges meet within a cell: boxes and discs.
  bool has_corners() const { return kind_ != Kind::kTrack; }
  bool is_wheel() const { return kind_ == Kind::kTrack && half_.x() == 0.0; }
  /// Whether the body is long enough that its pitch and roll matter to the pressure below it.
  bool extended() const { return kind_ != Kind::kTrack || half_.x() > 0.0; }
  /// A plane that no part of a box or disc is below: its height over pose().translation(), world z,
  /// and its slopes to the east and north. Of other bodies, and of a disc on its edge, none: -inf.
  Eigen::Vector3d plane_below() const;
  /// The face below.
  RunFrame run_frame() const;
  /// The shorter side (or radius) of the body itself, a first guess at b, m.
  double narrow() const;

  /// Answers for all sample points from `first` on, a whole number of blocks. `edge`: side of the
  /// small square, m; the share falls linearly across the body's side over this length, so that
  /// sums over a lattice of such squares are exact for edges along the lattice.
  void surface(double edge, const PathHistory& path, FootprintSamples& samples,
               const Kernels& kernels = best_kernels(), size_t first = 0) const;
  /// The same without `passed`, which then means nothing.
  void surface(double edge, FootprintSamples& samples,
               const Kernels& kernels = best_kernels()) const;
  /// Lower bound of the body's lower surface, m, world z, inside a square of side `edge` whose
  /// centre the body does not cover.
  double lowest_at_rim(double edge) const;

 private:
  Footprint(Kind kind, const Eigen::Vector3d& half, double radius)
      : kind_(kind), half_(half), radius_(radius) {
    set_pose(Eigen::Isometry3d::Identity());
  }
  void surface(double edge, const PathHistory* path, FootprintSamples& samples,
               const Kernels& kernels, size_t first) const;
  void track_surface(double edge, const PathHistory* path, FootprintSamples& samples,
                     const Kernels& kernels, size_t first) const;
  void box_surface(double edge, FootprintSamples& samples, size_t first) const;
  void disc_surface(double edge, FootprintSamples& samples, size_t first) const;

  Eigen::Vector3d local_half() const;
  Eigen::Vector3d world_reach() const;

  Kind kind_;
  Eigen::Vector3d half_;  ///< as half() gives it
  double radius_;
  Eigen::Isometry3d pose_;
  Eigen::Matrix3d to_local_;
  Eigen::Vector3d up_;  ///< the world's vertical in local axes

  // Of a track, once a pose instead of once a sample point.
  double square_ = 1.0;  ///< of the vertical's part in the x-z plane
  double root_ = 1.0;    ///< square root of square_
};

}  // namespace screed
