// Sixteen contacts at once, with AVX-512.
#include <immintrin.h>
#include <math.h>

#include "host_sim/physics/particles/bed_kernel.h"

#define SCREED_BED_TARGET __attribute__((target("avx2,avx512f,avx512vl,avx512dq")))

namespace screed {

namespace {

#include "host_sim/physics/particles/bed_rows_avx2.inc"

using Number = __m512;
using Mask = __mmask16;
constexpr size_t kLanes = 16;
// With full masks: without them gcc 12 warns of its own header.
constexpr __mmask16 kAll = 0xFFFF;

SCREED_BED_TARGET inline Number broadcast(float value) {
  return _mm512_set1_ps(value);
}
SCREED_BED_TARGET inline Number lanes(const float* from) {
  return _mm512_load_ps(from);
}
SCREED_BED_TARGET inline void store_lanes(Number from, float* to) {
  _mm512_store_ps(to, from);
}
SCREED_BED_TARGET inline Number root(Number a) {
  return _mm512_maskz_sqrt_ps(kAll, a);
}
SCREED_BED_TARGET inline Mask above(Number a, Number b) {
  return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ);
}
SCREED_BED_TARGET inline Mask both(Mask a, Mask b) {
  return static_cast<Mask>(a & b);
}
SCREED_BED_TARGET inline bool any(Mask a) {
  return a != 0;
}
SCREED_BED_TARGET inline Number choose(Mask mask, Number yes, Number no) {
  return _mm512_mask_blend_ps(mask, no, yes);
}

/// Four columns from, or to, four registers with rows n, n + 4, n + 8, n + 12 in their quarters.
SCREED_BED_TARGET inline void transpose_quarters(const Number (&from)[4], Number (&to)[4]) {
  const Number low = _mm512_maskz_unpacklo_ps(kAll, from[0], from[1]);
  const Number low_next = _mm512_maskz_unpacklo_ps(kAll, from[2], from[3]);
  const Number high = _mm512_maskz_unpackhi_ps(kAll, from[0], from[1]);
  const Number high_next = _mm512_maskz_unpackhi_ps(kAll, from[2], from[3]);
  to[0] = _mm512_maskz_shuffle_ps(kAll, low, low_next, _MM_SHUFFLE(1, 0, 1, 0));
  to[1] = _mm512_maskz_shuffle_ps(kAll, low, low_next, _MM_SHUFFLE(3, 2, 3, 2));
  to[2] = _mm512_maskz_shuffle_ps(kAll, high, high_next, _MM_SHUFFLE(1, 0, 1, 0));
  to[3] = _mm512_maskz_shuffle_ps(kAll, high, high_next, _MM_SHUFFLE(3, 2, 3, 2));
}
SCREED_BED_TARGET inline void transpose(const float (&rows)[kLanes][4], Number (&columns)[4]) {
  Number quarters[4];
  for (size_t i = 0; i < 4; ++i) {
    Number quarter = _mm512_castps128_ps512(_mm_load_ps(rows[i]));
    quarter = _mm512_maskz_insertf32x4(kAll, quarter, _mm_load_ps(rows[i + 4]), 1);
    quarter = _mm512_maskz_insertf32x4(kAll, quarter, _mm_load_ps(rows[i + 8]), 2);
    quarters[i] = _mm512_maskz_insertf32x4(kAll, quarter, _mm_load_ps(rows[i + 12]), 3);
  }
  transpose_quarters(quarters, columns);
}
SCREED_BED_TARGET inline void transpose_back(const Number (&columns)[4], float (&rows)[kLanes][4]) {
  constexpr __mmask8 kFour = 0xF;
  Number quarters[4];
  transpose_quarters(columns, quarters);
  for (size_t i = 0; i < 4; ++i) {
    _mm_store_ps(rows[i], _mm512_maskz_extractf32x4_ps(kFour, quarters[i], 0));
    _mm_store_ps(rows[i + 4], _mm512_maskz_extractf32x4_ps(kFour, quarters[i], 1));
    _mm_store_ps(rows[i + 8], _mm512_maskz_extractf32x4_ps(kFour, quarters[i], 2));
    _mm_store_ps(rows[i + 12], _mm512_maskz_extractf32x4_ps(kFour, quarters[i], 3));
  }
}

#include "host_sim/physics/particles/bed_kernel.inc"

}  // namespace

const BedFunctions kAvx512BedFunctions = {collide_pairs, collide_walls, move};

}  // namespace screed
