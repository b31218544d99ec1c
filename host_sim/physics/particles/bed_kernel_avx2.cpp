// Eight contacts at once, with AVX2.
#include <immintrin.h>
#include <math.h>

#include "host_sim/physics/particles/bed_kernel.h"

#define SCREED_BED_TARGET __attribute__((target("avx2")))

namespace screed {

namespace {

#include "host_sim/physics/particles/bed_rows_avx2.inc"

using Number = __m256;
using Mask = __m256;
constexpr size_t kLanes = 8;

SCREED_BED_TARGET inline Number broadcast(float value) {
  return _mm256_set1_ps(value);
}
SCREED_BED_TARGET inline Number lanes(const float* from) {
  return _mm256_load_ps(from);
}
SCREED_BED_TARGET inline void store_lanes(Number from, float* to) {
  _mm256_store_ps(to, from);
}
SCREED_BED_TARGET inline Number root(Number a) {
  return _mm256_sqrt_ps(a);
}
SCREED_BED_TARGET inline Mask above(Number a, Number b) {
  return _mm256_cmp_ps(a, b, _CMP_GT_OQ);
}
SCREED_BED_TARGET inline Mask both(Mask a, Mask b) {
  return _mm256_and_ps(a, b);
}
SCREED_BED_TARGET inline bool any(Mask a) {
  return _mm256_movemask_ps(a) != 0;
}
SCREED_BED_TARGET inline Number choose(Mask mask, Number yes, Number no) {
  return _mm256_blendv_ps(no, yes, mask);
}

/// Four columns from, or to, four registers with rows n and n + 4 in their halves.
SCREED_BED_TARGET inline void transpose_quarters(const Number (&from)[4], Number (&to)[4]) {
  const Number low = _mm256_unpacklo_ps(from[0], from[1]);
  const Number low_next = _mm256_unpacklo_ps(from[2], from[3]);
  const Number high = _mm256_unpackhi_ps(from[0], from[1]);
  const Number high_next = _mm256_unpackhi_ps(from[2], from[3]);
  to[0] = _mm256_shuffle_ps(low, low_next, _MM_SHUFFLE(1, 0, 1, 0));
  to[1] = _mm256_shuffle_ps(low, low_next, _MM_SHUFFLE(3, 2, 3, 2));
  to[2] = _mm256_shuffle_ps(high, high_next, _MM_SHUFFLE(1, 0, 1, 0));
  to[3] = _mm256_shuffle_ps(high, high_next, _MM_SHUFFLE(3, 2, 3, 2));
}
SCREED_BED_TARGET inline void transpose(const float (&rows)[kLanes][4], Number (&columns)[4]) {
  Number quarters[4];
  for (size_t i = 0; i < 4; ++i) {
    quarters[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(rows[i])),
                                       _mm_load_ps(rows[i + 4]), 1);
  }
  transpose_quarters(quarters, columns);
}
SCREED_BED_TARGET inline void transpose_back(const Number (&columns)[4], float (&rows)[kLanes][4]) {
  Number quarters[4];
  transpose_quarters(columns, quarters);
  for (size_t i = 0; i < 4; ++i) {
    _mm_store_ps(rows[i], _mm256_castps256_ps128(quarters[i]));
    _mm_store_ps(rows[i + 4], _mm256_extractf128_ps(quarters[i], 1));
  }
}

#include "host_sim/physics/particles/bed_kernel.inc"

}  // namespace

const BedFunctions kAvx2BedFunctions = {collide_pairs, collide_walls, move};

}  // namespace screed
