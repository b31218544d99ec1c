// Relief as a sum of waves, cones and a profile across a line.
#include "host_sim/physics/terrain/relief.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"

namespace screed {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kHighest_m = 127.0;

/// Heights in metres over a field's nodes, row by row.
using Heights = std::vector<double>;

/// sin and cos of `wave` turns over a side of `cells`, at each of `nodes`.
struct WaveAlong {
  WaveAlong(int wave, int nodes, int cells) {
    for (int i = 0; i < nodes; ++i) {
      const double angle = kTurn * static_cast<double>(wave * i % cells) / cells;
      const auto [s, c] = portable::sine_cosine(angle);
      cosine.push_back(c);
      sine.push_back(s);
    }
  }
  std::vector<double> cosine;
  std::vector<double> sine;
};

/// Gaussian random waves of a power-law spectrum with the bed's sides as periods.
void add_spectrum(const ReliefOptions& options, const HeightField& field, Heights& heights) {
  WorldRandom random(options.seed, "relief spectrum");
  const double width = field.x_max() - field.x_min();
  const double depth = field.y_max() - field.y_min();
  const int most_x = static_cast<int>(width / options.shortest_wave_m);
  const int most_y = static_cast<int>(depth / options.shortest_wave_m);
  const auto nx = static_cast<size_t>(field.nx());
  const auto ny = static_cast<size_t>(field.ny());
  Heights waves(nx * ny, 0.0);
  // Half of the plane of wave vectors: the other half are the same waves.
  for (int ky = 0; ky <= most_y; ++ky) {
    const WaveAlong y(ky, field.ny(), field.cells_y());
    for (int kx = ky == 0 ? 1 : -most_x; kx <= most_x; ++kx) {
      const double number = portable::hypot(kx / width, ky / depth);
      // Drawn whether it is in the band or not: a wave stays itself when the band is another.
      const double a = random.normal();
      const double b = random.normal();
      if (number * options.shortest_wave_m > 1.0 + 1e-9) continue;
      if (number * options.longest_wave_m < 1.0 - 1e-9) continue;
      const double amplitude = portable::pow(number, -0.5 * (options.exponent + 1.0));
      const WaveAlong x(kx, field.nx(), field.cells_x());
      for (size_t iy = 0; iy < ny; ++iy) {
        const double in_phase = amplitude * (a * y.cosine[iy] + b * y.sine[iy]);
        const double in_quadrature = amplitude * (b * y.cosine[iy] - a * y.sine[iy]);
        for (size_t ix = 0; ix < nx; ++ix) {
          waves[iy * nx + ix] += in_phase * x.cosine[ix] + in_quadrature * x.sine[ix];
        }
      }
    }
  }
  double sum = 0.0;
  for (const double wave : waves) sum += wave;
  const double mean = sum / static_cast<double>(waves.size());
  double squares = 0.0;
  for (const double wave : waves) squares += (wave - mean) * (wave - mean);
  if (squares == 0.0) {
    throw InputError("relief: no wave of " + std::to_string(options.shortest_wave_m) + " to " +
                     std::to_string(options.longest_wave_m) +
                     " m fits the bed's sides a whole number of times");
  }
  const double scale = options.rms_m / std::sqrt(squares / static_cast<double>(waves.size()));
  for (size_t i = 0; i < waves.size(); ++i) heights[i] += scale * (waves[i] - mean);
}

/// The shortest way from one place to another along an axis; with wrap round the end.
double apart(double difference, double side, bool wrap) {
  return wrap ? difference - side * std::round(difference / side) : difference;
}

void add_mounds(const ReliefOptions& options, const HeightField& field, Heights& heights) {
  WorldRandom random(options.seed, "relief mounds");
  const double slope = portable::tan(options.mound_slope_deg * kRadPerDeg);
  const double width = field.x_max() - field.x_min();
  const double depth = field.y_max() - field.y_min();
  const auto nx = static_cast<size_t>(field.nx());
  for (uint32_t mound = 0; mound < options.mounds; ++mound) {
    const double x = random.uniform(field.x_min(), field.x_max());
    const double y = random.uniform(field.y_min(), field.y_max());
    const double top = options.mound_height_m * random.uniform(0.5, 1.0);
    for (int iy = 0; iy < field.ny(); ++iy) {
      const double north = apart(field.node_y(iy) - y, depth, field.wrap());
      for (int ix = 0; ix < field.nx(); ++ix) {
        const double east = apart(field.node_x(ix) - x, width, field.wrap());
        heights[static_cast<size_t>(iy) * nx + static_cast<size_t>(ix)] +=
            std::max(0.0, top - slope * portable::hypot(east, north));
      }
    }
  }
}

/// Height across a trench, by the distance from its middle: a floor, flanks up to banks that hold
/// what was dug out, and their outer flanks.
class TrenchProfile {
 public:
  explicit TrenchProfile(const ReliefOptions& options)
      : slope_(portable::tan(options.trench_slope_deg * kRadPerDeg)),
        half_floor_(0.5 * options.trench_width_m),
        depth_(options.trench_depth_m),
        // A bank is a triangle of this height on the ground, and as large as half of the trench.
        bank_(std::sqrt(slope_ * depth_ * (half_floor_ + 0.5 * depth_ / slope_))) {}

  double at(double across) const {
    const double from_floor = std::abs(across) - half_floor_;
    if (from_floor <= 0.0) return -depth_;
    const double rising = -depth_ + slope_ * from_floor;
    const double falling = 2.0 * bank_ - rising;
    return std::min(rising, std::max(0.0, falling));
  }

 private:
  double slope_;
  double half_floor_;
  double depth_;
  double bank_;
};

void add_trench(const ReliefOptions& options, const HeightField& field, Heights& heights) {
  WorldRandom random(options.seed, "relief trench");
  const double width = field.x_max() - field.x_min();
  const double depth = field.y_max() - field.y_min();
  const double direction = random.uniform(0.0, std::numbers::pi);
  const double x = random.uniform(-0.125, 0.125) * width;
  const double y = random.uniform(-0.125, 0.125) * depth;
  const TrenchProfile profile(options);
  const auto [sine, cosine] = portable::sine_cosine(direction);
  const auto nx = static_cast<size_t>(field.nx());
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double across = (field.node_y(iy) - y) * cosine - (field.node_x(ix) - x) * sine;
      heights[static_cast<size_t>(iy) * nx + static_cast<size_t>(ix)] += profile.at(across);
    }
  }
}

}  // namespace

void add_relief(const ReliefOptions& options, HeightField& field) {
  const auto nx = static_cast<size_t>(field.nx());
  Heights heights(nx * static_cast<size_t>(field.ny()), 0.0);
  if (options.rms_m > 0.0) add_spectrum(options, field, heights);
  if (options.mounds > 0) add_mounds(options, field, heights);
  if (options.trench_depth_m > 0.0) add_trench(options, field, heights);
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double height = field.node(ix, iy) * kHeightUnit_m +
                            heights[static_cast<size_t>(iy) * nx + static_cast<size_t>(ix)];
      if (!(std::abs(height) <= kHighest_m)) {
        throw InputError("relief: a height of " + std::to_string(height) +
                         " m; allowed: -127 to 127");
      }
      field.set_node(ix, iy, static_cast<Height>(std::lround(height / kHeightUnit_m)));
    }
  }
  field.refresh_bounds();
}

}  // namespace screed
