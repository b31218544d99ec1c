// Two doubles at once, with the compilers' own vector types: element by element the same operations
// and so the same bits as one at a time.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace screed {

using Pair = double __attribute__((vector_size(16)));
/// Of comparisons: all bits set where true.
using PairMask = decltype(Pair{} < Pair{});

inline Pair both(double value) {
  return Pair{value, value};
}
inline Pair load(const double* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof pair);
  return pair;
}
inline void store(Pair pair, double* to) {
  std::memcpy(to, &pair, sizeof pair);
}
inline Pair smaller(Pair a, Pair b) {
  return a < b ? a : b;
}
inline Pair greater(Pair a, Pair b) {
  return a > b ? a : b;
}
inline Pair magnitude(Pair a) {
  return greater(a, -a);
}
inline Pair square_root(Pair a) {
  return Pair{std::sqrt(a[0]), std::sqrt(a[1])};
}
inline double sum(Pair a) {
  return a[0] + a[1];
}

}  // namespace screed
