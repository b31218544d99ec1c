// 32 robots a block, or one, with AVX-512 BW and VNNI.
#include <immintrin.h>

#include "nn/batch/block_kernel.h"
#include "nn/infer/tanh_table.h"

#define SCREED_NN_TARGET __attribute__((target("avx512f,avx512bw,avx512vnni")))

namespace screed::nn {

namespace {

using Vector = __m512i;

SCREED_NN_TARGET inline Vector load(const int16_t* from) {
  return _mm512_loadu_si512(from);
}
SCREED_NN_TARGET inline Vector load_sums(const int32_t* from) {
  return _mm512_loadu_si512(from);
}
SCREED_NN_TARGET inline void store(int16_t* to, Vector v) {
  _mm512_storeu_si512(to, v);
}
SCREED_NN_TARGET inline Vector zero() {
  return _mm512_setzero_si512();
}
SCREED_NN_TARGET inline Vector pairs_low(Vector a, Vector b) {
  return _mm512_unpacklo_epi16(a, b);
}
SCREED_NN_TARGET inline Vector pairs_high(Vector a, Vector b) {
  return _mm512_unpackhi_epi16(a, b);
}
SCREED_NN_TARGET inline Vector broadcast(int32_t value) {
  return _mm512_set1_epi32(value);
}
SCREED_NN_TARGET inline Vector multiply_add(Vector sum, Vector pairs, Vector weight) {
  return _mm512_dpwssd_epi32(sum, pairs, weight);
}
SCREED_NN_TARGET inline Vector shifted_and_narrowed(Vector low, Vector high, int shift) {
  // With a full mask: without one gcc 12 warns of its own header.
  constexpr __mmask16 kAll = 0xFFFF;
  const auto places = static_cast<unsigned>(shift);
  return _mm512_packs_epi32(_mm512_maskz_srai_epi32(kAll, low, places),
                            _mm512_maskz_srai_epi32(kAll, high, places));
}

// 128 numbers of the table at any index, from four registers: bit 6 of the index chooses the pair.
SCREED_NN_TARGET inline Vector looked_up(const int16_t* table, Vector index) {
  const Vector first = _mm512_permutex2var_epi16(load(table), index, load(table + 32));
  const Vector second = _mm512_permutex2var_epi16(load(table + 64), index, load(table + 96));
  return _mm512_mask_blend_epi16(_mm512_test_epi16_mask(index, _mm512_set1_epi16(64)), first,
                                 second);
}

SCREED_NN_TARGET inline Vector tanh_q15(Vector z) {
  const Vector sign = _mm512_srai_epi16(z, 15);
  const Vector magnitude = _mm512_xor_si512(z, sign);
  const Vector index = _mm512_srli_epi16(magnitude, 8);
  const Vector begin = looked_up(screed_nn_tanh_table, index);
  const Vector rise = _mm512_sub_epi16(looked_up(screed_nn_tanh_table + 1, index), begin);
  const Vector y =
      _mm512_add_epi16(begin, _mm512_mulhi_epu16(rise, _mm512_slli_epi16(magnitude, 8)));
  return _mm512_xor_si512(y, sign);
}

#include "nn/batch/block_layers.inc"

}  // namespace

SCREED_NN_TARGET void run_block_avx512(const BlockLayer* layers, size_t count, const int16_t* in,
                                       int16_t* out, size_t stride) {
  all_layers(layers, count, in, out, stride);
}

SCREED_NN_TARGET void run_one_avx512(const LaneLayer* layers, size_t count, const int16_t* in,
                                     int16_t* out, size_t outputs) {
  all_layers_of_one(layers, count, in, out, outputs);
}

}  // namespace screed::nn
