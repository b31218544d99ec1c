// Which way ground has to go for the site to become level, and how much of it, from the slopes that
// the robot drove over.
//
// The map is a grid of cells over the site. Each remembers the slope that pitch and roll showed
// there; heights follow from slopes, and a flow from heights. Of all flows that level the site it
// is the one with the least sum of squares: down a potential whose Laplacian is minus the height
// about the mean, and none through the edge (docs/algorithms.md, Strokes). A hump of a few steps
// asks for little flow, however steep it is, and the slant of the whole site for much.
//
// Heights and potential are found by relaxation (Gauss and Seidel), a cell a tick for good, so they
// follow what is learned within some seconds and no error adds up along the way.
//
// What the sensor shows on level ground is learned as well: it turns with the robot, slopes do not.
#pragma once

#include <stdint.h>

#include "firmware/leveling/behaviour.h"
#include "firmware/leveling/site.h"

namespace screed {

class FlowMap {
 public:
  explicit FlowMap(const Parameters& parameters) : site_(parameters) {}

  /// Every tick. steady: the robot drives so that pitch and roll show the ground's slope; only then
  /// the map learns.
  void tick(const LevelingInput& input, bool steady);

  /// Where ground below the robot has to come from: ahead and left, 2.7 cells squared times an
  /// Angle of slope; of what is finer than a slant up to a quarter less (flow_map_test.cpp). A
  /// quarter of the slope that it feels counts with it: what is steep moves more easily, and cells
  /// are wider than humps.
  void source(const LevelingInput& input, int16_t (&from)[2]) const;

  const SiteRectangle& site() const { return site_; }

 private:
  static constexpr uint8_t kSide = 6;  ///< cells along each side of the site, an even number
  struct Cell {
    int16_t uphill[2];  ///< to the east and to the north
    int16_t height;
    int16_t potential;
  };

  static void settle(Cell* here, uint8_t axis);
  Angle uphill(uint8_t axis) const;
  uint8_t spot(const int16_t (&mm)[2], uint8_t (&at)[2]) const;
  void learn(const LevelingInput& input);
  void relax();

  SiteRectangle site_;
  uint8_t next_ = 0;    ///< cell to relax
  uint8_t column_ = 0;  ///< of it
  Angle felt_[2]{};     ///< pitch and roll with a lag
  int32_t level_[2]{};  ///< what they are on level ground, 2^-16
  Cell cells_[kSide * kSide]{};
};

}  // namespace screed
