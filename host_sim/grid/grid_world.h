// The grid world: its terrain, heights of stacks in units made of noise or read from an image; and
// the world itself, who stands where and how level it is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "host_sim/core/random.h"
#include "host_sim/grid/grid_agents.h"

namespace screed {

/// The largest side of a grid, cells.
inline constexpr int kLargestGridSide = 4096;

enum class GridBorder {
  kWalls,  ///< steps out of the grid fail
  kTorus,  ///< opposite sides touch
};

struct GridTerrain {
  int width = 0;                  ///< cells in x, 1..kLargestGridSide
  int height = 0;                 ///< cells in y
  std::vector<uint16_t> heights;  ///< units, row by row, 0..kMaxStackHeight

  [[nodiscard]] uint64_t sum() const;
};

struct NoiseParameters {
  int width = 32;
  int height = 32;
  double mean = 6.5;       ///< units; the sum of all heights is round(mean * cells)
  double amplitude = 5.0;  ///< units, of the highest or lowest place before rounding
  double lattice = 10.0;   ///< cells between two lattice points of the noise
  GridBorder border = GridBorder::kWalls;  ///< on a torus the noise wraps as well: the lattice is
                                           ///< stretched to a whole number of periods
};

/// One octave of Perlin's gradient noise (K. Perlin, "Improving noise", 2002; gradients of any
/// direction), shifted to mean 0 and scaled to greatest magnitude 1, f; heights round(mean +
/// amplitude f), at least 0; then single units are added or removed at random places until the sum
/// is exact. The same generator gives the same terrain.
GridTerrain noise_terrain(const NoiseParameters& parameters, WorldRandom& random);

/// A grey image as terrain: black is 0, white is `white` units, rounded; each cell is the mean of
/// the pixels it covers. width and height 0: a cell a pixel. Row 0 of the image is the row of
/// greatest y. Throws InputError as read_grey_image() does, and when the grid would be larger than
/// kLargestGridSide or finer than the image.
GridTerrain image_terrain(const std::filesystem::path& path, int width, int height, double white);

/// Adds or removes single units at random places (nothing below 0) until the sum is `sum`.
void adjust_sum(GridTerrain& terrain, uint64_t sum, WorldRandom& random);

// The world. Every change updates the level measures, so that asking for them costs nothing. Knows
// no algorithm; agents act on it through GridSwarm. A world has no random state.

/// When a terrain counts as level. Units that agents carry are not part of it.
enum class GridStop {
  kLevel,      ///< highest - lowest stack <= epsilon
  kGradient,   ///< |(h(x+1,y) - h(x,y), h(x,y+1) - h(x,y))| <= epsilon in every cell (thesis 4.1)
  kDeviation,  ///< standard deviation of all heights <= epsilon
};

struct GridStopRule {
  GridStop measure = GridStop::kLevel;
  double epsilon = 1.0;  ///< units; units per cell for the gradient
};

/// Names a cell, or a place of the frame around the grid.
using GridPlace = uint32_t;

class GridWorld {
 public:
  GridWorld(const GridTerrain& terrain, GridBorder border, const GridStopRule& stop);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] GridPlace place(int x, int y) const {
    return static_cast<GridPlace>((y + 1) * stride_ + x + 1);
  }
  [[nodiscard]] int x(GridPlace place) const { return static_cast<int>(place) % stride_ - 1; }
  [[nodiscard]] int y(GridPlace place) const { return static_cast<int>(place) / stride_ - 1; }

  [[nodiscard]] uint16_t stack(GridPlace place) const { return cells_[place].stack; }
  /// The stacks as they are now.
  [[nodiscard]] GridTerrain terrain() const;

  /// The neighbour in a direction 0..7, or `from` itself when that is outside or occupied.
  [[nodiscard]] GridPlace step(GridPlace from, uint8_t direction) const {
    const auto there = static_cast<GridPlace>(static_cast<int>(from) + offsets_[direction]);
    if (cells_[there].state == State::kFree) return there;
    if (cells_[there].state == State::kFrame && border_ == GridBorder::kTorus) {
      const GridPlace across = wrap(there);
      if (cells_[across].state == State::kFree) return across;
    }
    return from;
  }
  [[nodiscard]] bool is_free(GridPlace place) const { return cells_[place].state == State::kFree; }
  void occupy(GridPlace place) { cells_[place].state = State::kOccupied; }
  void leave(GridPlace place) { cells_[place].state = State::kFree; }

  /// Take a unit off a stack of at least one; put one onto a stack below kMaxStackHeight.
  void pick_up(GridPlace place) { change(place, -1); }
  void deposit(GridPlace place) { change(place, 1); }

  [[nodiscard]] uint16_t lowest() const { return lowest_; }
  [[nodiscard]] uint16_t highest() const { return highest_; }
  [[nodiscard]] uint64_t sum() const { return sum_; }
  [[nodiscard]] uint64_t cells() const {
    return static_cast<uint64_t>(width_) * static_cast<uint64_t>(height_);
  }
  /// Standard deviation of the heights, units.
  [[nodiscard]] double deviation() const;
  /// Stacks of exactly this height.
  [[nodiscard]] uint32_t stacks_of(uint16_t stack) const {
    return stack < histogram_.size() ? histogram_[stack] : 0;
  }
  /// Whether the stop rule is met.
  [[nodiscard]] bool is_level() const;
  /// Fewest pick-ups after which all stacks could lie within one unit, when at most `spare` units
  /// more than now may end up carried, or are carried now and come back: the least over the levels
  /// L that the sum allows of max(units above L + 1, units missing below L).
  [[nodiscard]] uint64_t work_left(uint64_t carried, uint64_t agents) const;

 private:
  enum class State : uint8_t { kFree, kOccupied, kFrame };
  struct GridCell {
    uint16_t stack = 0;
    State state = State::kFrame;
  };

  void change(GridPlace place, int by);
  [[nodiscard]] GridPlace wrap(GridPlace frame) const;
  [[nodiscard]] bool is_steep(GridPlace place) const;
  [[nodiscard]] uint32_t steep_around(GridPlace place) const;

  int width_;
  int height_;
  int stride_;
  GridBorder border_;
  GridStopRule stop_;
  int offsets_[kGridDirections];
  std::vector<GridCell> cells_;  ///< with a frame of one cell, so that no step needs a comparison
  std::vector<uint32_t> histogram_;
  uint16_t lowest_ = 0;
  uint16_t highest_ = 0;
  uint64_t sum_ = 0;
  uint64_t squares_ = 0;
  uint32_t steep_ = 0;  ///< cells whose gradient is too large; counted for that stop rule alone
};

}  // namespace screed
