// What a robot does that does not know any more where it is.
//
// It is lost when the standard deviation of its position along an axis exceeds the parameter
// lost_sigma. Then it stops with the fault lost, or seeks a wall, as the parameter lost_action
// says: it drives along the axis it knows least about, towards the wall that it believes nearer,
// until that has told it where it is (position_estimate.h) and the deviation is below half of
// lost_sigma.
#pragma once

#include <stdint.h>

#include "firmware/estimation/place.h"
#include "firmware/parameters/kept.h"
#include "firmware/parameters/parameters.h"

namespace screed {

/// Parameter lost_action.
enum class LostAction : uint8_t { kStop, kSeekWall };

class WallSearch {
 public:
  explicit WallSearch(const Parameters& parameters) : parameters_(parameters) {}
  /// Live parameters (parameters.h), at any time.
  void take(const Parameters& parameters) { keep(parameters_, parameters); }

  /// One tick. Returns true while the robot is to drive towards (east, north).
  bool update(const Place& place);
  /// Lost, and not seeking a wall: in this tick.
  bool gave_up() const { return gave_up_; }
  /// How far the walls are from the middle of the site, east and north, mm; 0: none.
  const int16_t* walls() const { return &parameters_.values[Parameters::k_site_x]; }
  int16_t east() const { return towards_[kX]; }
  int16_t north() const { return towards_[kY]; }

 private:
  Kept<Parameters> parameters_;
  bool lost_ = false;
  bool gave_up_ = false;
  int16_t towards_[2] = {0, 0};
};

}  // namespace screed
