// A robot seen from above: where it is, and how far it comes in a frame of 10 ms.
#pragma once

namespace screed {

/// A frame's motion in the robot's own axes.
struct FrameMotion {
  double forward_m = 0.0;
  double sideways_m = 0.0;  ///< to the left
  double turn_rad = 0.0;    ///< counter-clockwise
};

struct PlanarPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;  ///< counter-clockwise from east, not wrapped

  /// Along an arc: half of the turn comes first.
  void move(const FrameMotion& motion);
  /// From `earlier` to here, in the axes of here.
  FrameMotion since(const PlanarPose& earlier) const;
};

}  // namespace screed
