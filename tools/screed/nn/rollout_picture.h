// A rollout as a picture: the paths on a map, and how far each prediction is from the physics.
#pragma once

#include <string>
#include <vector>

#include "nn/surrogate/surrogate.h"

namespace screed {

/// How far a predicted robot is from the recorded one when that has driven this distance.
struct RolloutDeviation {
  double distance_m;
  double position_m;   ///< >= 0
  double heading_deg;  ///< positive: the prediction has turned further counter-clockwise
};

/// One row a pose, as many as both paths have; poses are of the same moments.
std::vector<RolloutDeviation> rollout_deviation(const std::vector<PlanarPose>& physics,
                                                const std::vector<PlanarPose>& predicted);

struct PredictedPath {
  std::string name;
  std::vector<PlanarPose> poses;
};

struct RolloutPicture {
  std::string title;
  std::vector<PlanarPose> physics;
  std::vector<PredictedPath> predictions;
};

/// The text of an SVG file: the map on the left; deviation of position and heading over the
/// distance on the right, physics being the zero line. Throws InputError when there is nothing to
/// draw.
std::string rollout_svg(const RolloutPicture& picture);

}  // namespace screed
