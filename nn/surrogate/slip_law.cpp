#include "nn/surrogate/slip_law.h"

#include <Eigen/Dense>
#include <array>
#include <vector>
#include "host_sim/core/constants.h"

namespace screed::nn {
namespace {

TrackInputs only(TrackInput input) {
  return TrackInputs::Unit(static_cast<int>(input));
}

/// Of forward, sideways and turn: the combinations of inputs that each is a sum of.
std::array<std::vector<TrackInputs>, 3> terms_of(SlipLaw law) {
  const TrackInputs left = only(TrackInput::kLeft);
  const TrackInputs right = only(TrackInput::kRight);
  std::array<std::vector<TrackInputs>, 3> terms;
  if (law == SlipLaw::kConstant || law == SlipLaw::kBySlope) {
    terms = {{{left + right}, {}, {right - left}}};
  } else {
    terms.fill({left, right});
  }
  if (law == SlipLaw::kBySlope || law == SlipLaw::kRotationCentresAndSlope) {
    terms[0].push_back(only(TrackInput::kClimb));
    terms[1].push_back(only(TrackInput::kLean));
    terms[2].push_back(only(TrackInput::kLean));
    terms[2].push_back(only(TrackInput::kLeanAhead));
  }
  return terms;
}

}  // namespace

const char* name_of(SlipLaw law) {
  switch (law) {
    case SlipLaw::kConstant:
      return "constant slip";
    case SlipLaw::kBySlope:
      return "slip by slope";
    case SlipLaw::kRotationCentres:
      return "rotation centres";
    case SlipLaw::kRotationCentresAndSlope:
      return "centres and slope";
  }
  return "";
}

TrackKinematics fitted_kinematics(SlipLaw law, std::span<const MotionSeries> series) {
  Eigen::Matrix<double, kTrackInputs, kTrackInputs> squares;
  Eigen::Matrix<double, kTrackInputs, 3> products;
  squares.setZero();
  products.setZero();
  for (const MotionSeries& one : series) {
    for (const MotionFrame& frame : one) {
      const TrackInputs inputs = track_inputs(frame.track_left_m_per_s, frame.track_right_m_per_s,
                                              frame.pitch, frame.roll);
      const FrameMotion& m = frame.motion;
      squares += inputs * inputs.transpose();
      products += inputs * Eigen::RowVector3d(m.forward_m, m.sideways_m, m.turn_rad) / kTick_s;
    }
  }
  TrackKinematics fitted;
  const auto terms = terms_of(law);
  for (std::size_t output = 0; output < terms.size(); ++output) {
    const auto row = static_cast<int>(output);
    if (terms[output].empty()) continue;
    Eigen::MatrixXd basis(kTrackInputs, terms[output].size());
    for (std::size_t i = 0; i < terms[output].size(); ++i) {
      basis.col(static_cast<int>(i)) = terms[output][i];
    }
    // Where a drive does not tell two inputs apart, the least constants.
    const Eigen::MatrixXd normal = basis.transpose() * squares * basis;
    const Eigen::VectorXd factors =
        normal.completeOrthogonalDecomposition().solve(basis.transpose() * products.col(row));
    fitted.per_second.row(row) = (basis * factors).transpose();
  }
  return fitted;
}

}  // namespace screed::nn
