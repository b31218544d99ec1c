#include "nn/surrogate/motion_series.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/session_reader.h"
#include "nn/surrogate/support.h"
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

}  // namespace screed::nn
