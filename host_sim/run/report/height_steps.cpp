// Sparse differences of quantised maps.
#include "host_sim/run/report/height_steps.h"

#include <algorithm>
#include <cmath>

#include "host_sim/render/report/page_file.h"

namespace screed {
namespace {

constexpr double kFinestUnit_m = 1e-4;
constexpr double kUnits = 65535.0;

void append_leb128(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  while (value >= 0x80U) {
    bytes.push_back(static_cast<std::uint8_t>(value | 0x80U));
    value >>= 7U;
  }
  bytes.push_back(static_cast<std::uint8_t>(value));
}

std::uint32_t zigzag(std::int32_t value) {
  return value < 0 ? 2U * static_cast<std::uint32_t>(-(value + 1)) + 1U
                   : 2U * static_cast<std::uint32_t>(value);
}

/// One after the other as one.
CoarseChanges joined(const CoarseChanges& a, const CoarseChanges& b) {
  CoarseChanges both;
  auto ia = a.begin();
  auto ib = b.begin();
  while (ia != a.end() || ib != b.end()) {
    if (ib == b.end() || (ia != a.end() && ia->node < ib->node)) {
      both.push_back(*ia++);
    } else if (ia == a.end() || ib->node < ia->node) {
      both.push_back(*ib++);
    } else {
      if (ia->by + ib->by != 0) both.push_back({ia->node, ia->by + ib->by});
      ++ia;
      ++ib;
    }
  }
  return both;
}

/// Places of the merged nodes along one side: the middle of those that each stands for.
std::vector<double> places(double origin_m, double spacing_m, int nodes, int merged) {
  std::vector<double> result;
  for (int first = 0; first < nodes; first += merged) {
    const int last = std::min(first + merged, nodes) - 1;
    result.push_back(origin_m + 0.5 * (first + last) * spacing_m);
  }
  return result;
}

int merged_nodes(const HeightMapGeometry& g) {
  return (static_cast<int>(std::max(g.nx, g.ny)) + CoarseGrid::kMaxSide - 1) / CoarseGrid::kMaxSide;
}

}  // namespace

CoarseGrid::CoarseGrid(const HeightMapGeometry& g)
    : merged(merged_nodes(g)),
      x_m(places(g.origin_x_m, g.spacing_m, static_cast<int>(g.nx), merged)),
      y_m(places(g.origin_y_m, g.spacing_m, static_cast<int>(g.ny), merged)) {}

std::vector<double> CoarseGrid::heights_m(const HeightField& field) const {
  std::vector<double> heights;
  heights.reserve(nodes());
  for (int south = 0; south < field.ny(); south += merged) {
    for (int west = 0; west < field.nx(); west += merged) {
      std::int64_t sum = 0;
      const int north = std::min(south + merged, field.ny());
      const int east = std::min(west + merged, field.nx());
      for (int iy = south; iy < north; ++iy) {
        for (int ix = west; ix < east; ++ix) sum += field.node(ix, iy);
      }
      heights.push_back(kHeightUnit_m * static_cast<double>(sum) /
                        ((north - south) * (east - west)));
    }
  }
  return heights;
}

HeightSteps::HeightSteps(const CoarseGrid& grid, const HeightField& first, double low_m,
                         double high_m)
    : grid_(grid),
      scale_{low_m, std::max(kFinestUnit_m, (high_m - low_m) / kUnits)},
      start_(quantised(first)),
      now_(start_) {}

std::vector<std::uint16_t> HeightSteps::quantised(const HeightField& field) const {
  std::vector<std::uint16_t> units;
  units.reserve(grid_.nodes());
  for (const double height_m : grid_.heights_m(field)) {
    const double unit = std::round((height_m - scale_.low_m) / scale_.unit_m);
    units.push_back(static_cast<std::uint16_t>(std::clamp(unit, 0.0, kUnits)));
  }
  return units;
}

void HeightSteps::add(const HeightField& field) {
  const std::vector<std::uint16_t> next = quantised(field);
  CoarseChanges changes;
  for (std::size_t i = 0; i < next.size(); ++i) {
    if (next[i] != now_[i]) {
      changes.push_back({static_cast<std::uint32_t>(i), std::int32_t{next[i]} - now_[i]});
    }
  }
  steps_.push_back(std::move(changes));
  now_ = next;
}

std::uint32_t HeightSteps::fit(std::size_t max_bytes) {
  std::uint32_t moments = 1;
  while (steps_.size() > 1 && deflated(packed_steps()).size() > max_bytes) {
    std::vector<CoarseChanges> fewer;
    for (std::size_t i = 0; i < steps_.size(); i += 2) {
      fewer.push_back(i + 1 < steps_.size() ? joined(steps_[i], steps_[i + 1]) : steps_[i]);
    }
    steps_ = std::move(fewer);
    moments *= 2;
  }
  return moments;
}

std::vector<std::uint8_t> HeightSteps::packed_start() const {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(2 * start_.size());
  const std::size_t columns = grid_.x_m.size();
  for (std::size_t i = 0; i < start_.size(); ++i) {
    const std::uint32_t left = i % columns == 0 ? 0U : start_[i - 1];
    const std::uint32_t difference = std::uint32_t{start_[i]} - left;
    bytes.push_back(static_cast<std::uint8_t>(difference));
    bytes.push_back(static_cast<std::uint8_t>(difference >> 8U));
  }
  return bytes;
}

std::vector<std::uint8_t> HeightSteps::packed_steps() const {
  std::vector<std::uint8_t> bytes;
  for (const CoarseChanges& changes : steps_) {
    append_leb128(bytes, static_cast<std::uint32_t>(changes.size()));
    std::uint32_t next = 0;
    for (const CoarseChange& change : changes) {
      append_leb128(bytes, change.node - next);
      append_leb128(bytes, zigzag(change.by));
      next = change.node + 1;
    }
  }
  return bytes;
}

}  // namespace screed
