// What the programs of this folder have in common. They are made of nothing but this project's
// sources, Eigen and a C++ compiler, have no files and no model of a robot but their own, and print
// what each world has come to as a hash of its bits, the same on every processor (portable.mk
// compares).
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <numbers>

#include "host_sim/core/elementary.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// Of bits, by FNV-1a: the hash of sessions (core/content_hash.h) needs a library.
class Hash {
 public:
  void add(uint64_t bits) { value_ = (value_ ^ bits) * 0x100000001B3U; }
  void add(double number) { add(std::bit_cast<uint64_t>(number)); }
  void add(const Eigen::Vector3d& vector) {
    for (const double number : vector) add(number);
  }
  void add(const HeightField& field) {
    for (int iy = 0; iy < field.ny(); ++iy) {
      for (int ix = 0; ix < field.nx(); ++ix) add(static_cast<uint64_t>(field.node(ix, iy)));
    }
  }
  void print(const char* name) const { std::printf("%016" PRIx64 "  %s\n", value_, name); }

 private:
  uint64_t value_ = 0xCBF29CE484222325U;
};

/// Hills of 40 mm.
inline HeightField hills(int nodes, double cell_m) {
  const double k = 4.0 * std::numbers::pi / (nodes * cell_m);
  return HeightField::from_function(nodes, nodes, cell_m, true, [k](double x, double y) {
    return 0.02 * portable::sin(k * x) * portable::cos(k * y);
  });
}

}  // namespace screed
