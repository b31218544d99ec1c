// Terrains and worlds.
#include "host_sim/grid/grid_world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/grid/grid_agents.h"
#include "host_sim/physics/terrain/grey_image.h"

namespace screed {

namespace {

/// Gradients at the points of a lattice, and the noise between them.
class PerlinNoise {
 public:
  /// wraps: the noise repeats after columns and rows of the lattice.
  PerlinNoise(int columns, int rows, bool wraps, WorldRandom& random)
      : columns_(wraps ? columns : columns + 1), rows_(wraps ? rows : rows + 1) {
    gradients_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
    for (Gradient& gradient : gradients_) gradient = random_direction(random);
  }

  /// At a place in lattice units.
  double at(double x, double y) const {
    const double left = std::floor(x);
    const double top = std::floor(y);
    const double dx = x - left;
    const double dy = y - top;
    const int column = static_cast<int>(left);
    const int row = static_cast<int>(top);
    const double u = fade(dx);
    const double upper = mix(dot(column, row, dx, dy), dot(column + 1, row, dx - 1.0, dy), u);
    const double lower =
        mix(dot(column, row + 1, dx, dy - 1.0), dot(column + 1, row + 1, dx - 1.0, dy - 1.0), u);
    return mix(upper, lower, fade(dy));
  }

 private:
  struct Gradient {
    double x;
    double y;
  };

  /// A unit vector; by rejection, since sine and cosine differ between machines.
  static Gradient random_direction(WorldRandom& random) {
    for (;;) {
      const double x = random.uniform(-1.0, 1.0);
      const double y = random.uniform(-1.0, 1.0);
      const double square = x * x + y * y;
      if (square > 1.0 || square < 1e-6) continue;
      const double length = std::sqrt(square);
      return {x / length, y / length};
    }
  }
  static double fade(double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }
  static double mix(double from, double to, double part) { return from + part * (to - from); }

  double dot(int column, int row, double dx, double dy) const {
    const auto index = static_cast<size_t>(row % rows_) * static_cast<size_t>(columns_) +
                       static_cast<size_t>(column % columns_);
    return gradients_[index].x * dx + gradients_[index].y * dy;
  }

  int columns_;
  int rows_;
  std::vector<Gradient> gradients_;
};

/// Cells between lattice points: as asked, or the nearest that fits the torus a whole number of
/// times.
double spacing(int cells, double lattice, GridBorder border) {
  if (border == GridBorder::kWalls) return lattice;
  return cells / std::max(1.0, std::round(cells / lattice));
}

}  // namespace

uint64_t GridTerrain::sum() const {
  return std::accumulate(heights.begin(), heights.end(), uint64_t{0});
}

GridTerrain noise_terrain(const NoiseParameters& parameters, WorldRandom& random) {
  const double spacing_x = spacing(parameters.width, parameters.lattice, parameters.border);
  const double spacing_y = spacing(parameters.height, parameters.lattice, parameters.border);
  // The margin keeps 32 / (32 / 3) from becoming 4.
  const auto periods = [](int cells, double step) {
    return std::max(1, static_cast<int>(std::ceil(cells / step - 1e-9)));
  };
  const PerlinNoise noise(periods(parameters.width, spacing_x),
                          periods(parameters.height, spacing_y),
                          parameters.border == GridBorder::kTorus, random);

  const size_t cells =
      static_cast<size_t>(parameters.width) * static_cast<size_t>(parameters.height);
  std::vector<double> values;
  values.reserve(cells);
  for (int y = 0; y < parameters.height; ++y) {
    for (int x = 0; x < parameters.width; ++x) {
      values.push_back(noise.at((x + 0.5) / spacing_x, (y + 0.5) / spacing_y));
    }
  }
  const double mean =
      std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(cells);
  double greatest = 0.0;
  for (double& value : values) {
    value -= mean;
    greatest = std::max(greatest, std::fabs(value));
  }
  const double scale = greatest > 0.0 ? parameters.amplitude / greatest : 0.0;

  GridTerrain terrain{parameters.width, parameters.height, {}};
  terrain.heights.reserve(cells);
  for (const double value : values) {
    const double height = std::round(parameters.mean + scale * value);
    terrain.heights.push_back(
        static_cast<uint16_t>(std::clamp(height, 0.0, static_cast<double>(kMaxStackHeight))));
  }
  adjust_sum(terrain,
             static_cast<uint64_t>(std::llround(parameters.mean * static_cast<double>(cells))),
             random);
  return terrain;
}

GridTerrain image_terrain(const std::filesystem::path& path, int width, int height, double white) {
  const GreyImage image = read_grey_image(path);
  GridTerrain terrain{width == 0 ? image.width : width, height == 0 ? image.height : height, {}};
  const auto text = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
  if (terrain.width > kLargestGridSide || terrain.height > kLargestGridSide) {
    throw InputError(path.string() + ": " + text(terrain.width, terrain.height) +
                     " pixels; a grid has at most " + std::to_string(kLargestGridSide) +
                     " cells a side: choose a smaller --size");
  }
  if (terrain.width > image.width || terrain.height > image.height) {
    throw InputError(path.string() + ": has " + text(image.width, image.height) +
                     " pixels, fewer than the grid's " + text(terrain.width, terrain.height) +
                     " cells");
  }
  for (int y = terrain.height - 1; y >= 0; --y) {
    const int top = static_cast<int>(int64_t{y} * image.height / terrain.height);
    const int bottom = static_cast<int>(int64_t{y + 1} * image.height / terrain.height);
    for (int x = 0; x < terrain.width; ++x) {
      const int left = static_cast<int>(int64_t{x} * image.width / terrain.width);
      const int right = static_cast<int>(int64_t{x + 1} * image.width / terrain.width);
      double total = 0.0;
      for (int row = top; row < bottom; ++row) {
        for (int column = left; column < right; ++column) {
          total += image.samples[static_cast<size_t>(row) * static_cast<size_t>(image.width) +
                                 static_cast<size_t>(column)];
        }
      }
      const double mean = total / ((bottom - top) * (right - left));
      terrain.heights.push_back(static_cast<uint16_t>(std::lround(mean / image.max_value * white)));
    }
  }
  return terrain;
}

void adjust_sum(GridTerrain& terrain, uint64_t sum, WorldRandom& random) {
  uint64_t now = terrain.sum();
  const auto cells = static_cast<double>(terrain.heights.size());
  while (now != sum) {
    uint16_t& height = terrain.heights[static_cast<size_t>(random.uniform() * cells)];
    if (now < sum) {
      if (height == kMaxStackHeight) continue;
      ++height;
      ++now;
    } else if (height > 0) {
      --height;
      --now;
    }
  }
}

// The grid world and its level measures.

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
