// All particles of a bed sorted by the cubes of its grid: for those who look at most of them at
// once. Chains of the grid lead all over the memory; these are read one after the other.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/physics/particles/bed_particles.h"
#include "host_sim/physics/particles/sphere_grid.h"

namespace screed {

class CellRuns {
 public:
  struct Entry {
    double at[3];
    int32_t particle;
    bool awake;
  };

  void sort(const SphereGrid& grid, const BedParticles& particles) {
    begin_.assign(grid.cells() + 1, 0);
    for (size_t i = 0; i < particles.size; ++i) ++begin_[cell(grid, i)];
    int32_t sum = 0;
    for (int32_t& begin : begin_) {  // becomes the end of the cell's run
      sum += begin;
      begin = sum;
    }
    entries_.resize(particles.size);
    for (size_t i = particles.size; i-- > 0;) {
      const double* const at = particles.place[i].at;
      entries_[static_cast<size_t>(--begin_[cell(grid, i)])] = {
          {at[0], at[1], at[2]}, static_cast<int32_t>(i), particles.state[i] != 0};
    }
  }

  /// As SphereGrid::visit_near, with entries.
  template <class Visit>
  void visit_near(const SphereGrid& grid, const Eigen::Vector3d& position, double radius,
                  const Visit& visit) const {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(radius);
    grid.visit_cells(position - reach, position + reach, [&](int32_t begin, int32_t end) {
      const auto last = static_cast<size_t>(begin_[static_cast<size_t>(end)]);
      for (auto i = static_cast<size_t>(begin_[static_cast<size_t>(begin)]); i < last; ++i) {
        visit(entries_[i]);
      }
    });
  }

 private:
  static size_t cell(const SphereGrid& grid, size_t particle) {
    return static_cast<size_t>(grid.cell_of(static_cast<int32_t>(particle)));
  }

  std::vector<int32_t> begin_;  // of each cell's run, and the end of the last
  std::vector<Entry> entries_;
};

}  // namespace screed
