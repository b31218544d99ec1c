// How a robot spends its time and works its site: how long it could not do its work, since it was
// stuck, tilted past the limit, off its site or on the way back, and how much of the site it has
// visited. By the truth of the simulation, not by what the robot knows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "hal/sample.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/physics/terrain/terrain.h"

namespace screed {

struct TraversabilityLimits {
  double half_tread_m = 0.0;   ///< half the distance between the tracks
  double tilt_rad = 0.0;       ///< inclination past which the chassis counts as tilted
  double site_radius_m = 0.0;  ///< of the circle round the start; 0: none
  BedBounds bed{};             ///< what of it is in the circle, or all of it, is the site
};

/// The part of the site that a robot has visited: of the squares of 50 mm whose centres lie on the
/// site the share whose centres have come under the robot, closer to its middle than half its
/// tread.
class SiteCoverage {
 public:
  /// The robot's middle at the start, in the axes of the bed, m.
  SiteCoverage(const TraversabilityLimits& limits, double start_x, double start_y);

  /// The robot's middle is so far east and north of the start, m.
  void visit(double east, double north);

  /// 0..1; not a number where the site has no edge: no circle, on a bed that repeats.
  double share() const;

 private:
  enum class Square : uint8_t { kElsewhere, kToVisit, kVisited };

  double reach_m_;
  double west_ = 0.0;  ///< edges of the squares, from the start
  double south_ = 0.0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Square> squares_;
  int of_site_ = 0;
  int visited_ = 0;
};

/// Shares of the time so far, 0..1; 0 before the first frame.
struct Traversability {
  double stuck = 0.0;
  double tilted = 0.0;
  double off_site = 0.0;
  double returning = 0.0;  ///< the algorithm drives back to its site
  double visited = std::numeric_limits<double>::quiet_NaN();  ///< of the site (SiteCoverage)
  double slip = 0.0;  ///< mean magnitude of both tracks' slip while the faster one runs
};

/// Looks at every frame of a run. A robot is stuck when its tracks have run over the second up to
/// now, at 0.03 m/s or more in the mean, and the chassis has travelled less than a fifth of what
/// the faster track has, in the sense in which the tracks ran: along, and in turns at the radius of
/// a track.
class TraversabilityMeter {
 public:
  explicit TraversabilityMeter(const TraversabilityLimits& limits) : limits_(limits) {}

  /// returns: the algorithm drives back to the site.
  void on_tick(const SimFrame& frame, bool returns = false);

  Traversability shares() const;

 private:
  /// Travel of one tick, m.
  struct Travel {
    double forward = 0.0;  ///< > 0 with the tracks' mean
    double turn = 0.0;     ///< > 0 with the tracks' difference
    double track = 0.0;    ///< of the faster one, >= 0
  };

  bool is_stuck(const SimFrame& frame);
  bool is_off_site(const SimFrame& frame) const;

  TraversabilityLimits limits_;
  std::array<Travel, kTickRate_hz> second_{};  ///< the last one, by tick
  uint64_t ticks_ = 0;
  uint64_t stuck_ = 0;
  uint64_t tilted_ = 0;
  uint64_t off_site_ = 0;
  uint64_t returning_ = 0;
  uint64_t running_ = 0;  ///< ticks with running tracks
  double slip_sum_ = 0.0;
  double east_m_ = 0.0;  ///< from the start
  double north_m_ = 0.0;
  std::optional<SiteCoverage> coverage_;  ///< from the first frame on
};

}  // namespace screed
