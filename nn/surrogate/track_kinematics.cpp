#include "nn/surrogate/track_kinematics.h"

#include <cmath>
#include "host_sim/core/constants.h"

namespace screed::nn {
namespace {}  // namespace

TrackInputs track_inputs(double left_m_per_s, double right_m_per_s, double pitch, double roll) {
  const double mean = 0.5 * (left_m_per_s + right_m_per_s);
  TrackInputs inputs;
  inputs << left_m_per_s, right_m_per_s, std::abs(mean) * pitch, std::abs(mean) * roll, mean * roll;
  return inputs;
}

FrameMotion TrackKinematics::motion(double left_m_per_s, double right_m_per_s, double pitch,
                                    double roll) const {
  const Eigen::Vector3d moved =
      kTick_s * per_second * track_inputs(left_m_per_s, right_m_per_s, pitch, roll);
  return {moved.x(), moved.y(), moved.z()};
}

TrackKinematics skid_kinematics(double speed_share, double tread_m) {
  TrackKinematics kinematics;
  kinematics.per_second.row(0).head<2>().setConstant(0.5 * speed_share);
  kinematics.per_second.row(2).head<2>() << -1.0 / tread_m, 1.0 / tread_m;
  return kinematics;
}

}  // namespace screed::nn
