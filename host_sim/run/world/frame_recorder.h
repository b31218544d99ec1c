// Makes one frame of a session from the world's truth and from what the robot thinks.
#pragma once

#include <Eigen/Core>

#include "firmware/robot/robot.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/physics/world/environment.h"

namespace screed {

class FrameRecorder {
 public:
  /// The frame of this tick: the plant as the sample saw it, the robot after its answer.
  SimFrame record(double time_s, const RobotView& plant, const Robot& robot);

  /// Length of the chassis' path so far, m.
  double distance_m() const { return distance_m_; }

 private:
  bool first_ = true;
  Eigen::Vector3d last_travelled_ = Eigen::Vector3d::Zero();
  double last_heading_ = 0.0;
  double distance_m_ = 0.0;
};

}  // namespace screed
