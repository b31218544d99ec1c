// How much of its time a robot could not do its work: stuck, tilted past the limit, or off its
// site. By the truth of the simulation, not by what the robot knows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/sample.h"
#include "host_sim/core/sim_frame.h"

namespace screed {

struct TraversabilityLimits {
  double half_tread_m = 0.0;   ///< half the distance between the tracks
  double tilt_rad = 0.0;       ///< inclination past which the chassis counts as tilted
  double site_radius_m = 0.0;  ///< of the circle round the start that is the site; 0: none
};

/// Shares of the time so far, 0..1; 0 before the first frame.
struct Traversability {
  double stuck = 0.0;
  double tilted = 0.0;
  double off_site = 0.0;
  double slip = 0.0;  ///< mean magnitude of both tracks' slip while the faster one runs
};

/// Looks at every frame of a run. A robot is stuck when its tracks have run over the second up to
/// now, at 0.03 m/s or more in the mean, and the chassis has travelled less than a fifth of what
/// the faster track has, in the sense in which the tracks ran: along, and in turns at the radius of
/// a track.
class TraversabilityMeter {
 public:
  explicit TraversabilityMeter(const TraversabilityLimits& limits) : limits_(limits) {}

  /// on_bed: whether the robot's middle is on the bed.
  void on_tick(const SimFrame& frame, bool on_bed);

  Traversability shares() const;

 private:
  /// Travel of one tick, m.
  struct Travel {
    double forward = 0.0;  ///< > 0 with the tracks' mean
    double turn = 0.0;     ///< > 0 with the tracks' difference
    double track = 0.0;    ///< of the faster one, >= 0
  };

  bool is_stuck(const SimFrame& frame);

  TraversabilityLimits limits_;
  std::array<Travel, kTickRate_hz> second_{};  ///< the last one, by tick
  uint64_t ticks_ = 0;
  uint64_t stuck_ = 0;
  uint64_t tilted_ = 0;
  uint64_t off_site_ = 0;
  uint64_t running_ = 0;  ///< ticks with running tracks
  double slip_sum_ = 0.0;
  double east_m_ = 0.0;  ///< from the start
  double north_m_ = 0.0;
};

}  // namespace screed
