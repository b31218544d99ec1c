// Rectangles within rectangles.
#include "host_sim/physics/world/wall_clearance.h"

#include <array>
#include <cstdio>
#include <string>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

std::string to_millimetre(double metres) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3f", metres);
  return text.data();
}

std::string area(const Eigen::Vector2d& size) {
  return to_millimetre(size.x()) + " m x " + to_millimetre(size.y()) + " m";
}

}  // namespace

Eigen::Vector2d out_of_walls(const BedBounds& bed, const Eigen::AlignedBox2d& outline) {
  const Eigen::Vector2d none = Eigen::Vector2d::Zero();
  if (bed.edge != BedEdge::kWalled) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d corner(0.5 * bed.width_m, 0.5 * bed.depth_m);
  return (-corner - outline.min()).cwiseMax(none) - (outline.max() - corner).cwiseMax(none);
}

void check_between_walls(const BedBounds& bed, const Eigen::AlignedBox2d& outline,
                         const Eigen::Vector2d& start, size_t number, size_t robots) {
  if (bed.edge != BedEdge::kWalled) return;
  const Eigen::Vector2d corner(0.5 * bed.width_m, 0.5 * bed.depth_m);
  if (Eigen::AlignedBox2d(-corner, corner).contains(outline)) return;
  const Eigen::Vector2d low = start - outline.min() - corner;
  const Eigen::Vector2d high = corner - (outline.max() - start);
  if ((low.array() > high.array()).any()) {
    throw InputError("[map] edges = walls: a bed of " + area(2.0 * corner) +
                     " is too small for a robot of " + area(outline.sizes()) + " at this heading");
  }
  const auto range = [&](Eigen::Index axis) {
    return to_millimetre(low[axis]) + ".." + to_millimetre(high[axis]) + " m";
  };
  const std::string x = to_millimetre(start.x());
  const std::string y = to_millimetre(start.y());
  const std::string placed =
      robots == 1 ? "[vehicle] x = " + x + " m, [vehicle] y = " + y + " m puts the robot"
                  : "[robots] count = " + std::to_string(robots) + " puts robot " +
                        std::to_string(number) + ", at x = " + x + " m, y = " + y + " m,";
  throw InputError(placed + " into a wall of the bed; it takes " + area(outline.sizes()) +
                   " at this heading: allowed are x " + range(0) + " and y " + range(1));
}

void refuse_overlap(size_t one, size_t other, size_t robots) {
  throw InputError("[robots] count = " + std::to_string(robots) + " puts robots " +
                   std::to_string(one) + " and " + std::to_string(other) +
                   " into one another; put them further apart");
}

}  // namespace screed
