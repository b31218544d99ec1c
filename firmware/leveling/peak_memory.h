// Peak memory (thesis 7.1.1): the robot remembers how high its site is where, from the slopes that
// it drove over, goes to high places and wears them down.
//
// The map is a square of heights over the site. Between four of them the ground is bilinear; the
// slope that pitch and roll show there says by how much their differences are wrong, and they are
// corrected by a share of that, in pairs of opposite sign (the method of Kaczmarz for linear
// equations). So nothing is integrated along the way: a wrong place shifts what is written and does
// not add up, and the mean of the map stays 0.
//
// Where to go: of some random points of the site, the highest. There it spins, the longer the
// higher it is above the mean.
#pragma once

#include "firmware/leveling/behaviour.h"
#include "firmware/leveling/site.h"
#include "firmware/math/random.h"

namespace screed {

class PeakMemory : public AlgorithmDefaults {
 public:
  explicit PeakMemory(const Parameters& parameters);
  void take(const Parameters& parameters) { keep(parameters_, parameters); }

  MotionCommand tick(const LevelingInput& input, Behaviour& behaviour);

  /// Of the ground above the map's mean at so many mm east and north of the origin, 1/32 mm.
  int16_t height(const int16_t (&mm)[2]) const;

 private:
  static constexpr uint8_t kSide = 12;  ///< heights along an axis

  /// A place in the map.
  struct Spot {
    uint8_t south_west;  ///< number of the height there
    uint8_t part[2];     ///< of the way from it to the next, along each axis, 2^-8
  };
  Spot spot(const int16_t (&mm)[2]) const;
  void learn(const LevelingInput& input);
  void choose_target();

  Kept<Parameters> parameters_;
  Random random_;
  SiteRectangle site_;
  int16_t target_mm_[2] = {0, 0};
  uint16_t ticks_left_ = 0;  ///< of the way to the target, or of the spin
  uint8_t ticks_ = 0;        ///< since it learned last
  bool spin_left_ = true;
  int16_t heights_[kSide * kSide] = {};  ///< 1/32 mm, from the south-west, eastward
};

}  // namespace screed
