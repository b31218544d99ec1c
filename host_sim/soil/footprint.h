// The lower surface of what presses on soil, in closed form: wheels, tracks, boxes and discs in any
// attitude.
//
// A footprint answers, for a vertical line at (x, y): does the body cross it, how low does it
// reach, and which way does its surface face there. A convex body's lowest point on the line is
// where the line, going up, enters it.
#pragma once

#include <Eigen/Geometry>

namespace screed {

struct FootprintPoint {
  double share;            ///< 0..1: how much of a small square at (x, y) the body covers
  double height;           ///< of the lower surface, m
  Eigen::Vector3d normal;  ///< into the body, unit length, normal.z() > 0
  double flat_within;      ///< the surface is plane at least this far around, m
  double passed_forward;   ///< lowest height of the body that passed over (x, y) when it came along
                           ///< its local x, m
  double passed_backward;  ///< the same when it came the other way
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
  /// How far the body reaches down from pose().translation(), at most, m.
  double reach_down() const;
  /// Whether the touched area is a disc: then the b of Bekker's formula is its radius, else the
  /// shorter side of a rectangle.
  bool round() const { return kind_ == Kind::kDisc; }
  /// Whether two edges meet within a cell: boxes and discs.
  bool has_corners() const { return kind_ != Kind::kTrack; }
  /// Whether the body is long enough that its pitch and roll matter to the pressure below it.
  bool extended() const { return kind_ != Kind::kTrack || half_.x() > 0.0; }
  /// The shorter side (or radius) of the body itself, a first guess at b, m.
  double narrow() const;

  /// `edge`: side of the small square, m; the share falls linearly across the body's side over this
  /// length, so that sums over a lattice of such squares are exact for edges along the lattice.
  /// Returns false when the body does not cover the square at all.
  bool at(double x, double y, double edge, FootprintPoint& point) const;

 private:
  Footprint(Kind kind, const Eigen::Vector3d& half, double radius)
      : kind_(kind), half_(half), radius_(radius) {
    set_pose(Eigen::Isometry3d::Identity());
  }
  bool at_track(const Eigen::Vector3d& local, double edge, FootprintPoint& point) const;
  bool at_box(const Eigen::Vector3d& local, double edge, FootprintPoint& point) const;
  bool at_disc(const Eigen::Vector3d& local, double edge, FootprintPoint& point) const;

  Eigen::Vector3d world_reach() const;

  Kind kind_;
  Eigen::Vector3d half_;  ///< half extents: run, radius-free width, height
  double radius_;
  Eigen::Isometry3d pose_;
  Eigen::Matrix3d to_local_;
  Eigen::Vector3d up_;  ///< the world's vertical in local axes

  // Of a track, once a pose instead of once a place.
  double square_ = 1.0;       ///< of the vertical's part in the x-z plane
  double root_ = 1.0;         ///< of square_
  double lowest_at_[2] = {};  ///< local x of the lowest points of rear and front wheel
  double lowest_[2] = {};     ///< their heights at local y = 0, m
};

}  // namespace screed
