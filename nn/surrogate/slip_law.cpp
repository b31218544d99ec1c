#include "nn/surrogate/slip_law.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/session_reader.h"
#include "nn/surrogate/surrogate.h"
#include "schema/values.h"

namespace screed::nn {
namespace {

constexpr std::uint64_t kBlockRows = 4096;

/// Bilinear heights of a recorded map.
class MapHeights {
 public:
  explicit MapHeights(const HeightMap& map) : map_(map) {}
  double operator()(double x_m, double y_m) const {
    const HeightMapGeometry& g = map_.geometry;
    const Place u = place((x_m - g.origin_x_m) / g.spacing_m, g.nx);
    const Place v = place((y_m - g.origin_y_m) / g.spacing_m, g.ny);
    const double south = at(u.low, v.low) + u.fraction * (at(u.high, v.low) - at(u.low, v.low));
    const double north = at(u.low, v.high) + u.fraction * (at(u.high, v.high) - at(u.low, v.high));
    return (south + v.fraction * (north - south)) * g.unit_m;
  }

 private:
  struct Place {
    std::size_t low;
    std::size_t high;
    double fraction;
  };
  Place place(double node, std::uint32_t nodes) const {
    if (!map_.geometry.wrap) {
      const double inside = std::clamp(node, 0.0, static_cast<double>(nodes - 1));
      const auto low = static_cast<std::size_t>(std::min(inside, static_cast<double>(nodes - 2)));
      return {low, low + 1, inside - static_cast<double>(low)};
    }
    const double within = node - std::floor(node / nodes) * nodes;
    const std::size_t low = static_cast<std::size_t>(within) % nodes;
    return {low, (low + 1) % nodes, within - std::floor(within)};
  }
  double at(std::size_t ix, std::size_t iy) const {
    return map_.heights[iy * map_.geometry.nx + ix];
  }

  const HeightMap& map_;
};

}  // namespace

MotionSeries read_motion_series(const std::filesystem::path& session_folder) {
  const SessionReader session(session_folder / "session.h5");
  const Experiment experiment = read_experiment(session_folder / "experiment.ini");
  if (!experiment.map.is_soil()) {
    throw InputError(session_folder.string() + ": [map] model = " + experiment.map.model +
                     "; allowed is scm");
  }
  if (!session.has_heights()) {
    throw InputError(session_folder.string() +
                     ": no heights were recorded; screed record records them");
  }
  MotionSeries series;
  const SupportGeometry geometry;
  std::vector<SimFrame> rows;
  std::optional<SimFrame> before;
  double heading_rad = 0.0;
  for (std::uint64_t begin = 0; begin < session.frames(); begin += kBlockRows) {
    rows.resize(std::min(kBlockRows, session.frames() - begin));
    session.read(begin, rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const SimFrame& now = rows[i];
      if (now.leveling_state == static_cast<std::int32_t>(message::LevelingState::kTrainingDrive) &&
          before.has_value()) {
        const std::uint64_t tick = begin + i;
        if (series.empty()) heading_rad = before->yaw;
        const Support support =
            support_on(MapHeights(session.heights_after(tick)), geometry, before->x, before->y,
                       portable::cos(before->yaw), portable::sin(before->yaw));
        const double middle = heading_rad + 0.5 * now.delta_theta;
        const auto [s, c] = portable::sine_cosine(middle);
        const FrameMotion motion{now.delta_x * c + now.delta_y * s,
                                 now.delta_y * c - now.delta_x * s, now.delta_theta};
        heading_rad += now.delta_theta;
        series.push_back({motion, now.track_left, now.track_right, support.pitch, support.roll});
      }
      before = now;
    }
  }
  if (series.empty()) {
    throw InputError(session_folder.string() + ": Algorithm 5 drove no frame of it");
  }
  return series;
}

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
