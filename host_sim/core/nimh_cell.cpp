// Straight lines between points of the curve.
#include "host_sim/core/nimh_cell.h"

#include <cstddef>
#include <iterator>

namespace screed {
namespace {

struct Point {
  double cell_v;
  double charge;
};
constexpr Point kCurve[] = {{0.00, -0.05}, {1.00, 0.0}, {1.10, 0.05}, {1.20, 0.2},
                            {1.25, 0.5},   {1.30, 0.9}, {1.40, 1.0}};

/// `to` at the place where `from` has this value.
double along(double Point::*from, double Point::*to, double value) {
  const Point* above = kCurve + 1;
  while (above + 1 < std::end(kCurve) && value > above->*from) ++above;
  const Point* const below = above - 1;
  const double share = (value - below->*from) / (above->*from - below->*from);
  return below->*to + share * (above->*to - below->*to);
}

}  // namespace

double nimh_charge(double cell_v) {
  if (cell_v <= 1.0) return 0.0;
  return cell_v < 1.4 ? along(&Point::cell_v, &Point::charge, cell_v) : 1.0;
}

double nimh_cell_v(double charge) {
  if (charge <= kCurve[0].charge) return 0.0;
  return charge < 1.0 ? along(&Point::charge, &Point::cell_v, charge) : 1.4;
}

}  // namespace screed
