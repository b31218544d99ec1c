// The site as a rectangle: between its walls or, without walls, the square round its circle; with
// both what is in both.
#pragma once

#include <stdint.h>

#include "firmware/control/kinematics.h"
#include "firmware/estimation/place.h"
#include "firmware/math/random.h"
#include "firmware/math/units.h"
#include "firmware/parameters/kept.h"
#include "firmware/parameters/parameters.h"

namespace screed {

struct SiteRectangle {
  explicit SiteRectangle(const Parameters& parameters)
      : half_mm{parameters.site_x(), parameters.site_y()} {
    const int16_t radius = parameters.site_radius();
    for (int16_t& side : half_mm) {
      int16_t half = side;
      if (half == 0 || (radius != 0 && radius < half)) half = radius;
      side = clamp_i16(half, kMin_mm, kMax_mm);
    }
  }

  /// A random place, at least so far from the edge.
  void draw_place(Random& random, int16_t from_edge_mm, int16_t (&mm)[2]) const {
    for (uint8_t axis = kX; axis <= kY; ++axis) {
      const auto reach = static_cast<int16_t>(half_mm[axis] - from_edge_mm);
      mm[axis] = random.uniform(static_cast<int16_t>(-reach), reach);
    }
  }

  /// A random place just so far from the edge, on any side. Ways between two of them cover the site
  /// more evenly than those between places anywhere, which cross its middle.
  void draw_place_at_edge(Random& random, int16_t from_edge_mm, int16_t (&mm)[2]) const {
    draw_place(random, from_edge_mm, mm);
    const auto axis = static_cast<uint8_t>(random.uniform(kX, kY));
    const auto reach = static_cast<int16_t>(half_mm[axis] - from_edge_mm);
    mm[axis] = mm[axis] < 0 ? static_cast<int16_t>(-reach) : reach;
  }

  /// A place nearer to an edge than so far, or outside.
  bool near_edge(const int16_t (&mm)[2], int16_t from_edge_mm) const {
    return abs_i16(mm[kX]) > static_cast<uint16_t>(half_mm[kX] - from_edge_mm) ||
           abs_i16(mm[kY]) > static_cast<uint16_t>(half_mm[kY] - from_edge_mm);
  }

  int16_t half_mm[2];  ///< of the sides, east and north

 private:
  static constexpr int16_t kMin_mm = 300;            ///< twice the robot's half diagonal
  static constexpr int16_t kMax_mm = INT16_MAX / 2;  ///< so that distances fit 16 bits
};

// Keeps a robot that has no map on its site: outside a circle around the start it turns and drives
// back. The circle shrinks as the robot knows less where it is, by the standard deviation of the
// worse axis, down to half of its radius.

class SiteFence {
 public:
  /// site_radius: of the circle around the start; 0 switches the fence off. walk_speed_max: on the
  /// way back.
  explicit SiteFence(const Parameters& parameters) : parameters_(parameters) {}
  /// Live parameters (parameters.h), at any time.
  void take(const Parameters& parameters) { keep(parameters_, parameters); }

  /// Looks at the position. Returns whether the robot is outside the circle.
  bool update(const Place& place);
  /// It was at the last update.
  bool outside() const { return outside_; }

  /// The motion towards the point so far east and north of the robot, backwards where it lies
  /// behind: on loose ground turning digs in. Turns on the spot while it lies aside, drives as soon
  /// as it lies within 45 degrees.
  SCREED_OUT_OF_LINE MotionCommand steer(int16_t east_mm, int16_t north_mm, Angle heading) const;

 private:
  Kept<Parameters> parameters_;
  bool outside_ = false;
};

}  // namespace screed
