// A robot's path and what happened to it, for its page.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/core/json.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/render/report/page_file.h"

namespace screed {

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
  void add(const SimFrame& frame);
  /// Sets "leveling" and "supervisor" (lists of [begin s, end s, state]), "supervisor_states"
  /// (names by number) and "events" (time and text) of the object.
  void finish(Json& json) const;

 private:
  struct Band {
    double begin_s;
    double end_s;
    std::int32_t state;
  };
  struct Event {
    double time_s;
    std::string text;
  };
  static void extend(std::vector<Band>& bands, double time_s, std::int32_t state);

  std::vector<Band> leveling_;
  std::vector<Band> supervisor_;
  std::vector<Event> events_;
  std::int32_t faults_ = 0;
};

}  // namespace screed
