// The grid world and its level measures.
#include "host_sim/grid/grid_world.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace screed {
namespace {

constexpr int kStepX[kGridDirections] = {1, 1, 0, -1, -1, -1, 0, 1};
constexpr int kStepY[kGridDirections] = {0, 1, 1, 1, 0, -1, -1, -1};

}  // namespace

GridWorld::GridWorld(const GridTerrain& terrain, GridBorder border, const GridStopRule& stop)
    : width_(terrain.width),
      height_(terrain.height),
      stride_(terrain.width + 2),
      border_(border),
      stop_(stop),
      cells_(static_cast<size_t>(stride_) * static_cast<size_t>(terrain.height + 2)) {
  for (int direction = 0; direction < kGridDirections; ++direction) {
    offsets_[direction] = kStepY[direction] * stride_ + kStepX[direction];
  }
  lowest_ = *std::min_element(terrain.heights.begin(), terrain.heights.end());
  highest_ = *std::max_element(terrain.heights.begin(), terrain.heights.end());
  histogram_.resize(static_cast<size_t>(highest_) + 2);
  auto stack = terrain.heights.begin();
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x, ++stack) {
      cells_[place(x, y)] = {*stack, State::kFree};
      ++histogram_[*stack];
      sum_ += *stack;
      squares_ += uint64_t{*stack} * *stack;
    }
  }
  if (stop_.measure == GridStop::kGradient) {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) steep_ += is_steep(place(x, y)) ? 1U : 0U;
    }
  }
}

GridTerrain GridWorld::terrain() const {
  GridTerrain terrain{width_, height_, {}};
  terrain.heights.reserve(cells());
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) terrain.heights.push_back(stack(place(x, y)));
  }
  return terrain;
}

void GridWorld::change(GridPlace place, int by) {
  const bool counts_steep = stop_.measure == GridStop::kGradient;
  if (counts_steep) steep_ -= steep_around(place);
  const uint16_t before = cells_[place].stack;
  const auto after = static_cast<uint16_t>(before + by);
  cells_[place].stack = after;
  if (after >= histogram_.size()) histogram_.resize(static_cast<size_t>(after) + 1);
  --histogram_[before];
  ++histogram_[after];
  // A stack changes by one, so the ends of the range do as well.
  if (after > highest_ || (before == highest_ && histogram_[before] == 0)) highest_ = after;
  if (after < lowest_ || (before == lowest_ && histogram_[before] == 0)) lowest_ = after;
  sum_ = sum_ - before + after;
  squares_ = squares_ - uint64_t{before} * before + uint64_t{after} * after;
  if (counts_steep) steep_ += steep_around(place);
}

GridPlace GridWorld::wrap(GridPlace frame) const {
  return place((x(frame) + width_) % width_, (y(frame) + height_) % height_);
}

bool GridWorld::is_steep(GridPlace place) const {
  const auto rise = [&](uint8_t direction) {
    auto there = static_cast<GridPlace>(static_cast<int>(place) + offsets_[direction]);
    if (cells_[there].state == State::kFrame) {
      if (border_ == GridBorder::kWalls) return 0.0;
      there = wrap(there);
    }
    return static_cast<double>(stack(there)) - stack(place);
  };
  const double east = rise(0);
  const double north = rise(2);
  return east * east + north * north > stop_.epsilon * stop_.epsilon;
}

uint32_t GridWorld::steep_around(GridPlace place) const {
  constexpr uint8_t kWest = 4;
  constexpr uint8_t kSouth = 6;
  // On a grid that is one cell wide the torus makes a cell its own neighbour: count it once.
  GridPlace seen[3] = {place, place, place};
  int count = 1;
  for (const uint8_t direction : {kWest, kSouth}) {
    auto there = static_cast<GridPlace>(static_cast<int>(place) + offsets_[direction]);
    if (cells_[there].state == State::kFrame) {
      if (border_ == GridBorder::kWalls) continue;
      there = wrap(there);
    }
    if (std::find(seen, seen + count, there) == seen + count) seen[count++] = there;
  }
  uint32_t steep = 0;
  for (int i = 0; i < count; ++i) steep += is_steep(seen[i]) ? 1U : 0U;
  return steep;
}

double GridWorld::deviation() const {
  // Exact in integers up to here: n sum of squares - square of the sum.
  const auto n = static_cast<double>(cells());
  const double mean = static_cast<double>(sum_) / n;
  return std::sqrt(std::max(0.0, static_cast<double>(squares_) / n - mean * mean));
}

bool GridWorld::is_level() const {
  switch (stop_.measure) {
    case GridStop::kLevel:
      return highest_ - lowest_ <= stop_.epsilon;
    case GridStop::kGradient:
      return steep_ == 0;
    case GridStop::kDeviation:
      return deviation() <= stop_.epsilon;
  }
  return false;
}

uint64_t GridWorld::work_left(uint64_t carried, uint64_t agents) const {
  const uint64_t total = sum_ + carried;
  // With `held` units in the air at the end, the level is floor((total - held) / cells) or, when
  // that is a whole number, also the one below.
  const uint64_t least_sum = total > agents ? total - agents : 0;
  const uint64_t top = total / cells();
  uint64_t bottom = least_sum / cells();
  if (bottom > 0 && least_sum % cells() == 0) --bottom;
  uint64_t least = std::numeric_limits<uint64_t>::max();
  for (uint64_t level = bottom; level <= top; ++level) {
    uint64_t above = 0;
    uint64_t missing = 0;
    for (uint64_t stack = lowest_; stack <= highest_; ++stack) {
      const uint64_t count = histogram_[stack];
      if (stack > level + 1) above += count * (stack - level - 1);
      if (stack < level) missing += count * (level - stack);
    }
    least = std::min(least, std::max(above, missing));
  }
  return least;
}

}  // namespace screed
