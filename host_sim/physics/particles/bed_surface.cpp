// Rays from above on a bed of particles.
#include "host_sim/physics/particles/bed_surface.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace screed {
namespace {

int rays_along(double size, double spacing) {
  return std::max(2, static_cast<int>(std::lround(size / spacing)));
}

/// Spacing of a whole number of rays across the bed.
double whole_spacing(const BedExtent& extent, double spacing) {
  return extent.width_m / rays_along(extent.width_m, spacing);
}

/// The first ray of each column, and one more; column_of(ray) rises with the ray.
template <class ColumnOf>
std::vector<int> first_rays(int columns, int rays, const ColumnOf& column_of) {
  std::vector<int> first(static_cast<size_t>(columns) + 1, rays);
  for (int i = rays - 1; i >= 0; --i) first[static_cast<size_t>(column_of(i))] = i;
  for (int c = columns - 1; c >= 0; --c) {
    first[static_cast<size_t>(c)] =
        std::min(first[static_cast<size_t>(c)], first[static_cast<size_t>(c) + 1]);
  }
  return first;
}

}  // namespace

BedSurface::BedSurface(const BedExtent& extent, double ray_spacing_m, double radius_m,
                       const SphereGrid& grid)
    : extent_(extent),
      radius_m_(radius_m),
      field_(rays_along(extent.width_m, ray_spacing_m),
             rays_along(extent.depth_m, whole_spacing(extent, ray_spacing_m)),
             whole_spacing(extent, ray_spacing_m), extent.periodic) {
  field_.add_walls();  // unless it repeats
  const size_t columns =
      static_cast<size_t>(grid.columns_x()) * static_cast<size_t>(grid.columns_y());
  stale_.assign(columns, 0);
  to_cast_.assign(columns, 0);
  stale_columns_.reserve(columns);
  cast_columns_.reserve(columns);
  rays_x_ = first_rays(grid.columns_x(), field_.nx(),
                       [&](int i) { return grid.column_x(field_.node_x(i)); });
  rays_y_ = first_rays(grid.columns_y(), field_.ny(),
                       [&](int i) { return grid.column_y(field_.node_y(i)); });
}

void BedSurface::mark(const SphereGrid& grid, int32_t cell) {
  const size_t column = grid.column_of_cell(cell);
  if (stale_[column] != 0) return;
  stale_[column] = 1;
  stale_columns_.push_back(static_cast<int32_t>(column));
}

void BedSurface::cast(const SphereGrid& grid, const BedParticles& particles) {
  // A particle reaches into the columns beside its own.
  for (const int32_t column : stale_columns_) {
    stale_[static_cast<size_t>(column)] = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        int ix = column % grid.columns_x() + dx;
        int iy = column / grid.columns_x() + dy;
        if (!grid.wrap(ix, iy)) continue;
        const size_t beside = grid.column(ix, iy);
        if (to_cast_[beside] != 0) continue;
        to_cast_[beside] = 1;
        cast_columns_.push_back(static_cast<int32_t>(beside));
      }
    }
  }
  stale_columns_.clear();
  for (const int32_t column : cast_columns_) {
    to_cast_[static_cast<size_t>(column)] = 0;
    cast_rays(grid, particles, column % grid.columns_x(), column / grid.columns_x());
  }
  cast_columns_.clear();
}

void BedSurface::cast_rays(const SphereGrid& grid, const BedParticles& particles, int column_x,
                           int column_y) {
  for (int ry = rays_y_[static_cast<size_t>(column_y)];
       ry < rays_y_[static_cast<size_t>(column_y) + 1]; ++ry) {
    for (int rx = rays_x_[static_cast<size_t>(column_x)];
         rx < rays_x_[static_cast<size_t>(column_x) + 1]; ++rx) {
      const Eigen::Vector3d ray(field_.node_x(rx), field_.node_y(ry), 0.0);
      double height = 0.0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          int ix = column_x + dx;
          int iy = column_y + dy;
          if (!grid.wrap(ix, iy)) continue;
          for (int layer = grid.layers() - 1; layer >= 0; --layer) {
            // The highest layer has no upper side.
            if (layer + 1 < grid.layers() && grid.layer_top(layer) + radius_m_ <= height) break;
            for (int32_t particle = grid.first(grid.cell(ix, iy, layer));
                 particle != SphereGrid::kNone; particle = grid.next(particle)) {
              const Eigen::Vector3d to = between(extent_, ray, particles.at(particle));
              const double discriminant = radius_m_ * radius_m_ - to.x() * to.x() - to.y() * to.y();
              if (discriminant > 0.0) height = std::max(height, to.z() + std::sqrt(discriminant));
            }
          }
        }
      }
      field_.set_node(rx, ry, static_cast<Height>(std::lround(height / kHeightUnit_m)));
    }
  }
}

}  // namespace screed
