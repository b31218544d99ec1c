// Random numbers of a world: one seeded generator per component, so that adding a draw in one place
// changes nothing elsewhere.
//
// The generator is PCG32 (O'Neill 2014, XSH-RR 64/32); the distributions are our own, since those
// of the standard library differ between vendors. Integer arithmetic and IEEE operations only;
// std::log and std::sqrt in normal().
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

#include "host_sim/core/elementary.h"

namespace screed {

class WorldRandom {
 public:
  /// The stream is chosen by the world's seed and the component's name.
  WorldRandom(uint64_t seed, std::string_view component) {
    uint64_t hash = 0xCBF29CE484222325U;  // FNV-1a: any stable spreading of the name will do
    for (const char c : component) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
    increment_ = (hash << 1U) | 1U;
    next();
    state_ += seed;
    next();
  }

  uint32_t next() {
    const uint64_t old = state_;
    state_ = old * 6364136223846793005U + increment_;
    const auto mixed = static_cast<uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto rotation = static_cast<uint32_t>(old >> 59U);
    return (mixed >> rotation) | (mixed << ((32U - rotation) & 31U));
  }

  /// Uniform in [0, 1), 32 random bits.
  double uniform() { return next() * 0x1p-32; }
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Standard normal, by Marsaglia's polar method; pairs are kept.
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0.0;
    double v = 0.0;
    double s = 0.0;
    do {
      u = uniform(-1.0, 1.0);
      v = uniform(-1.0, 1.0);
      s = u * u + v * v;
    } while (s >= 1.0 || s == 0.0);
    const double factor = std::sqrt(-2.0 * portable::log(s) / s);
    spare_ = v * factor;
    has_spare_ = true;
    return u * factor;
  }

 private:
  uint64_t state_ = 0;
  uint64_t increment_ = 1;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace screed
