// Tileable gradient noise. Sums and products only, in a fixed order: the same bits everywhere.
#include "host_sim/physics/terrain/noise_terrain.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"

namespace screed {
namespace {

constexpr double kDiagonal = 0.70710678118654752;
constexpr double kGradients[8][2] = {
    {1.0, 0.0},  {kDiagonal, kDiagonal},   {0.0, 1.0},  {-kDiagonal, kDiagonal},
    {-1.0, 0.0}, {-kDiagonal, -kDiagonal}, {0.0, -1.0}, {kDiagonal, -kDiagonal}};

void require(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw InputError(std::string("noise terrain: ") + name + " = " + std::to_string(value) +
                   "; allowed: " + std::to_string(low) + " to " + std::to_string(high));
}

/// One octave: a lattice of gradients that repeats after `period` cells.
class Octave {
 public:
  Octave(int period, WorldRandom& random)
      : period_(period), gradients_(static_cast<size_t>(period) * static_cast<size_t>(period)) {
    for (uint8_t& gradient : gradients_) gradient = static_cast<uint8_t>(random.next() >> 29U);
  }

  /// At a place in lattice cells.
  double at(double x, double y) const {
    const int ix = static_cast<int>(x);
    const int iy = static_cast<int>(y);
    const double u = x - ix;
    const double v = y - iy;
    const double south = mix(corner(ix, iy, u, v), corner(ix + 1, iy, u - 1.0, v), fade(u));
    const double north =
        mix(corner(ix, iy + 1, u, v - 1.0), corner(ix + 1, iy + 1, u - 1.0, v - 1.0), fade(u));
    return mix(south, north, fade(v));
  }

 private:
  static double fade(double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }
  static double mix(double a, double b, double share) { return a + share * (b - a); }
  double corner(int ix, int iy, double dx, double dy) const {
    const size_t at = static_cast<size_t>(iy % period_) * static_cast<size_t>(period_) +
                      static_cast<size_t>(ix % period_);
    const double* gradient = kGradients[gradients_[at]];
    return gradient[0] * dx + gradient[1] * dy;
  }

  int period_;
  std::vector<uint8_t> gradients_;
};

}  // namespace

GreyImage noise_terrain(const NoiseTerrainOptions& options) {
  require("size", options.size, 16, 4096);
  require("waves", options.waves, 1, 64);
  require("octaves", options.octaves, 1, 10);
  require("persistence", options.persistence, 0, 1);

  const auto size = static_cast<size_t>(options.size);
  std::vector<double> heights(size * size, 0.0);
  WorldRandom random(options.seed, "noise terrain");
  double amplitude = 1.0;
  for (int o = 0; o < options.octaves; ++o) {
    // Two lattice cells make a wave. A lattice finer than the samples would be noise of its own.
    const int period = std::min(2 * options.waves << o, options.size);
    const Octave octave(period, random);
    const double cells = static_cast<double>(period) / options.size;
    for (size_t y = 0; y < size; ++y) {
      for (size_t x = 0; x < size; ++x) {
        heights[y * size + x] +=
            amplitude * octave.at(static_cast<double>(x) * cells, static_cast<double>(y) * cells);
      }
    }
    amplitude *= options.persistence;
  }

  const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
  const double low = *lowest;
  const double span = *highest - low;
  GreyImage image;
  image.width = options.size;
  image.height = options.size;
  image.bit_depth = 16;
  image.max_value = 65535;
  for (const double height : heights) {
    image.samples.push_back(
        static_cast<uint16_t>(std::floor((height - low) / span * 65535.0 + 0.5)));
  }
  return image;
}

}  // namespace screed
