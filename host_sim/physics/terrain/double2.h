// Two doubles at once, with the compilers' own vector types: element by element the same operations
// and so the same bits as one at a time.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace screed {

using Double2 = double __attribute__((vector_size(16)));
/// Of comparisons: all bits set where true.
using Mask2 = decltype(Double2{} < Double2{});

inline Double2 broadcast(double value) {
  return Double2{value, value};
}
inline Double2 load(const double* from) {
  Double2 lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
inline void store(Double2 lanes, double* to) {
  std::memcpy(to, &lanes, sizeof lanes);
}
inline Double2 minimum(Double2 a, Double2 b) {
  return a < b ? a : b;
}
inline Double2 maximum(Double2 a, Double2 b) {
  return a > b ? a : b;
}
inline Double2 magnitude(Double2 a) {
  return maximum(a, -a);
}
inline Double2 square_root(Double2 a) {
  return Double2{std::sqrt(a[0]), std::sqrt(a[1])};
}
inline double sum(Double2 a) {
  return a[0] + a[1];
}

}  // namespace screed
