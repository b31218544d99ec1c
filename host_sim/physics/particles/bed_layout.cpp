// Lays a bed of equal spheres below a surface.
#include "host_sim/physics/particles/bed_layout.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>

#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/core/random.h"
#include "host_sim/physics/particles/sphere_grid.h"

namespace screed {
namespace {

constexpr int64_t kMaxParticles = 4'000'000;
constexpr double kScatter = 0.4;      // of the place a particle is let down, in radii
constexpr double kFirstStride = 0.5;  // of the way into the hollow, in radii
constexpr double kLastStride = 0.01;
constexpr size_t kTile = 16;              // columns of the grid along each side of a tile
constexpr size_t kReportParticles = 256;  // laid between two reports: some milliseconds

/// Finds where spheres let down on those that lie already come to rest.
class Deposit {
 public:
  Deposit(const BedExtent& extent, double radius, int highest_stack, size_t particles)
      : extent_(extent),
        radius_(radius),
        grid_(extent.width_m, extent.depth_m, 2.0 * radius * (highest_stack + 1), 2.0 * radius,
              extent.periodic),
        top_layer_(static_cast<size_t>(grid_.columns_x()) * static_cast<size_t>(grid_.columns_y()),
                   0) {
    grid_.resize(particles);
    centres_.reserve(particles);
  }

  void let_down(double x, double y) {
    keep_inside(x, y);
    double height = resting_height(x, y);
    // Eight directions to try, from long strides to short ones: the lowest place is a hollow
    // between three spheres, where no stride leads further down.
    for (double stride = kFirstStride; stride >= kLastStride;) {
      double best_x = x;
      double best_y = y;
      double best = height;
      for (const auto& direction : kDirections) {
        double to_x = x + direction[0] * stride * radius_;
        double to_y = y + direction[1] * stride * radius_;
        keep_inside(to_x, to_y);
        const double there = resting_height(to_x, to_y);
        if (there < best) {
          best = there;
          best_x = to_x;
          best_y = to_y;
        }
      }
      if (best < height) {
        x = best_x;
        y = best_y;
        height = best;
      } else {
        stride *= 0.5;
      }
    }
    add_sphere({x, y, height});
  }

  /// The centres, tile after tile of the grid, in a tile column after column, each from below.
  std::vector<Eigen::Vector3d> take() {
    std::vector<int32_t> order(centres_.size());
    std::iota(order.begin(), order.end(), 0);
    const auto place = [this](int32_t i) {
      const auto columns_x = static_cast<size_t>(grid_.columns_x());
      const size_t column = grid_.column_of_cell(grid_.cell_of(i));
      const size_t tile_x = column % columns_x / kTile;
      const size_t tile_y = column / columns_x / kTile;
      return std::tuple(tile_y, tile_x, column, centres_[static_cast<size_t>(i)].z(), i);
    };
    std::sort(order.begin(), order.end(),
              [&](int32_t a, int32_t b) { return place(a) < place(b); });
    std::vector<Eigen::Vector3d> sorted;
    sorted.reserve(order.size());
    for (const int32_t i : order) sorted.push_back(centres_[static_cast<size_t>(i)]);
    return sorted;
  }

 private:
  static constexpr double kDiagonal = 0.70710678118654752;
  static constexpr double kDirections[8][2] = {
      {1, 0},  {kDiagonal, kDiagonal},   {0, 1},  {-kDiagonal, kDiagonal},
      {-1, 0}, {-kDiagonal, -kDiagonal}, {0, -1}, {kDiagonal, -kDiagonal}};

  void keep_inside(double& x, double& y) const {
    const double half_x = 0.5 * extent_.width_m;
    const double half_y = 0.5 * extent_.depth_m;
    if (extent_.periodic) {
      x -= extent_.width_m * std::floor((x + half_x) / extent_.width_m);
      y -= extent_.depth_m * std::floor((y + half_y) / extent_.depth_m);
    } else {
      x = std::clamp(x, -half_x + radius_, half_x - radius_);
      y = std::clamp(y, -half_y + radius_, half_y - radius_);
    }
  }

  /// Height of the centre of a sphere at (x, y) that lies on the highest one below it.
  double resting_height(double x, double y) const {
    const int cx = grid_.column_x(x);
    const int cy = grid_.column_y(y);
    const double reach2 = 4.0 * radius_ * radius_;
    double height = radius_;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        int ix = cx + dx;
        int iy = cy + dy;
        if (!grid_.wrap(ix, iy)) continue;
        for (int layer = top_layer_[grid_.column(ix, iy)]; layer >= 0; --layer) {
          if (grid_.layer_top(layer) + 2.0 * radius_ <= height) break;
          for (int32_t i = grid_.first(grid_.cell(ix, iy, layer)); i != SphereGrid::kNone;
               i = grid_.next(i)) {
            const Eigen::Vector3d& other = centres_[static_cast<size_t>(i)];
            const double ax = nearest(x - other.x(), extent_.width_m);
            const double ay = nearest(y - other.y(), extent_.depth_m);
            const double discriminant = reach2 - ax * ax - ay * ay;
            if (discriminant > 0.0) height = std::max(height, other.z() + std::sqrt(discriminant));
          }
        }
      }
    }
    return height;
  }

  double nearest(double difference, double period) const {
    if (!extent_.periodic) return difference;
    if (difference > 0.5 * period) return difference - period;
    return difference < -0.5 * period ? difference + period : difference;
  }

  void add_sphere(const Eigen::Vector3d& centre) {
    const int ix = grid_.column_x(centre.x());
    const int iy = grid_.column_y(centre.y());
    const int layer = grid_.layer(centre.z());
    grid_.insert(static_cast<int32_t>(centres_.size()), grid_.cell(ix, iy, layer));
    int& top = top_layer_[grid_.column(ix, iy)];
    top = std::max(top, layer);
    centres_.push_back(centre);
  }

  BedExtent extent_;
  double radius_;
  SphereGrid grid_;
  std::vector<int> top_layer_;  // of each column
  std::vector<Eigen::Vector3d> centres_;
};

}  // namespace

BedExtent bed_extent(const HeightField& top, double radius_m) {
  const auto stacks = [&](double size) {
    return std::max(2, static_cast<int>(std::lround(size / (2.0 * radius_m))));
  };
  BedExtent extent;
  extent.stacks_x = stacks(top.x_max() - top.x_min());
  extent.stacks_y = stacks(top.y_max() - top.y_min());
  extent.width_m = extent.stacks_x * 2.0 * radius_m;
  extent.depth_m = extent.stacks_y * 2.0 * radius_m;
  extent.periodic = top.wrap();
  return extent;
}

std::vector<int> stack_counts(const HeightField& top, const BedExtent& extent, double radius_m) {
  std::vector<int> counts;
  counts.reserve(static_cast<size_t>(extent.stacks_x) * static_cast<size_t>(extent.stacks_y));
  int64_t sum = 0;
  for (int iy = 0; iy < extent.stacks_y; ++iy) {
    const double y = (2 * iy + 1) * radius_m - 0.5 * extent.depth_m;
    for (int ix = 0; ix < extent.stacks_x; ++ix) {
      const double x = (2 * ix + 1) * radius_m - 0.5 * extent.width_m;
      counts.push_back(
          std::max(0, static_cast<int>(std::lround(top.at(x, y).height / (2.0 * radius_m)))));
      sum += counts.back();
    }
  }
  if (sum < 1 || sum > kMaxParticles) {
    throw InputError("[map] particle_radius, [particles] depth: " + std::to_string(sum) +
                     " particles of radius " + shortest(radius_m) +
                     " m fit below this surface; allowed: 1 to " + std::to_string(kMaxParticles));
  }
  return counts;
}

std::vector<Eigen::Vector3d> lay_spheres(const std::vector<int>& counts, const BedExtent& extent,
                                         double radius_m, uint64_t seed,
                                         const TaskProgress& progress) {
  WorldRandom random(seed, "particles");
  const int highest = *std::max_element(counts.begin(), counts.end());
  const auto all = static_cast<size_t>(std::accumulate(counts.begin(), counts.end(), int64_t{0}));
  Deposit deposit(extent, radius_m, highest, all);
  size_t laid = 0;
  std::vector<int> order(counts.size());
  std::iota(order.begin(), order.end(), 0);
  for (int layer = 0; layer < highest; ++layer) {
    for (size_t i = order.size() - 1; i > 0; --i) {
      std::swap(order[i],
                order[static_cast<size_t>(random.uniform() * static_cast<double>(i + 1))]);
    }
    for (const int stack : order) {
      if (counts[static_cast<size_t>(stack)] <= layer) continue;
      const int column = stack % extent.stacks_x;
      const int row = stack / extent.stacks_x;
      const double x = (2 * column + 1) * radius_m - 0.5 * extent.width_m;
      const double y = (2 * row + 1) * radius_m - 0.5 * extent.depth_m;
      const double off_x = random.uniform(-kScatter, kScatter) * radius_m;
      const double off_y = random.uniform(-kScatter, kScatter) * radius_m;
      deposit.let_down(x + off_x, y + off_y);
      if (++laid % kReportParticles == 0) report_progress(progress, "laying particles", laid, all);
    }
  }
  return deposit.take();
}

}  // namespace screed
