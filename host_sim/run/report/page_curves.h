// Curves and path of a run as a page shows them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/core/json.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/render/report/page_file.h"

namespace screed {

// A curve with as many samples as a screen can show, and none of its peaks lost.

/// Which ticks the samples of a curve stand for. A run of up to kMaxSamples ticks keeps them all.
/// A longer one is cut into buckets of equal numbers of ticks, the last one shorter; each gives two
/// samples, the lowest and the highest value in the order in which they occur.
struct CurveSampling {
  static constexpr std::uint64_t kMaxSamples = 3000;

  explicit CurveSampling(std::uint64_t ticks);
  /// Row of the session at which each sample is drawn. In a bucket: its first one and its middle,
  /// so a peak stands up to a bucket from where it was.
  std::vector<std::uint64_t> rows() const;

  std::uint64_t ticks;
  std::uint64_t bucket_ticks;  ///< 1: each tick is a sample
};

/// Takes the values of a curve tick by tick.
class CurveSampler {
 public:
  explicit CurveSampler(const CurveSampling& sampling) : sampling_(sampling) {}
  /// The value of the next tick; NaN where there is none.
  void add(double value);
  /// As many as CurveSampling::rows(), once all ticks were added; NaN for a bucket without values.
  std::vector<float> samples();

 private:
  void finish_bucket();

  CurveSampling sampling_;
  std::uint64_t in_bucket_ = 0;
  bool any_ = false;
  bool high_first_ = false;
  double low_ = 0.0;
  double high_ = 0.0;
  std::vector<float> samples_;
};

// A robot's path and what happened to it, for its page.

/// The driven path as at most kMaxPoints points at least 5 mm apart, or more where it is long.
class PageTrack {
 public:
  static constexpr std::size_t kMaxPoints = 12000;

  void add(std::uint64_t row, const SimFrame& frame);
  /// Adds the blocks `block`-rows (row of the session, uint32), -places (x, y, z in m, float) and
  /// -states (leveling state, uint32). Names them, and the points at which the robot has crossed
  /// the edge of a bed that repeats: no line leads to these.
  Json finish(PageFile& page, const std::string& block) const;

 private:
  struct Point {
    std::uint32_t row;
    double x;
    double y;
    double z;
    std::uint32_t state;
    std::int32_t beds_x;
    std::int32_t beds_y;
  };
  void thin();

  double spacing_m_ = 0.005;
  std::vector<Point> points_;
};

/// States over time and changes of them.
class PageEvents {
 public:
  struct Event {
    double time_s;
    std::string text;
    bool fault = false;  ///< one appeared
  };

  void add(const SimFrame& frame);
  /// So far.
  const std::vector<Event>& events() const { return events_; }
  /// Sets "leveling" and "supervisor" (lists of [begin s, end s, state]), "supervisor_states"
  /// (names by number) and "events" (time and text) of the object.
  void finish(Json& json) const;

 private:
  struct Band {
    double begin_s;
    double end_s;
    std::int32_t state;
  };
  static void extend(std::vector<Band>& bands, double time_s, std::int32_t state);

  std::vector<Band> leveling_;
  std::vector<Band> supervisor_;
  std::vector<Event> events_;
  std::int32_t faults_ = 0;
};

}  // namespace screed
