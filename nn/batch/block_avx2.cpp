// 16 robots a block, or one, with AVX2.
#include <immintrin.h>

#include "nn/batch/block_kernel.h"
#include "nn/infer/tanh_table.h"

#define SCREED_NN_TARGET __attribute__((target("avx2")))

namespace screed::nn {

namespace {

using Vector = __m256i;

SCREED_NN_TARGET inline Vector load(const int16_t* from) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(from));
}
SCREED_NN_TARGET inline Vector load_sums(const int32_t* from) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(from));
}
SCREED_NN_TARGET inline void store(int16_t* to, Vector v) {
  _mm256_storeu_si256(reinterpret_cast<__m256i_u*>(to), v);
}
SCREED_NN_TARGET inline Vector zero() {
  return _mm256_setzero_si256();
}
SCREED_NN_TARGET inline Vector pairs_low(Vector a, Vector b) {
  return _mm256_unpacklo_epi16(a, b);
}
SCREED_NN_TARGET inline Vector pairs_high(Vector a, Vector b) {
  return _mm256_unpackhi_epi16(a, b);
}
SCREED_NN_TARGET inline Vector broadcast(int32_t value) {
  return _mm256_set1_epi32(value);
}
SCREED_NN_TARGET inline Vector multiply_add(Vector sum, Vector pairs, Vector weight) {
  return _mm256_add_epi32(sum, _mm256_madd_epi16(pairs, weight));
}
SCREED_NN_TARGET inline Vector shifted_and_narrowed(Vector low, Vector high, int shift) {
  return _mm256_packs_epi32(_mm256_srai_epi32(low, shift), _mm256_srai_epi32(high, shift));
}

// Reads the ends of eight segments at once: two neighbours of the table are one 32-bit number.
SCREED_NN_TARGET inline Vector segment_ends(Vector index) {
  return _mm256_i32gather_epi32(reinterpret_cast<const int*>(screed_nn_tanh_table), index, 2);
}

SCREED_NN_TARGET inline Vector tanh_q15(Vector z) {
  const Vector sign = _mm256_srai_epi16(z, 15);
  const Vector magnitude = _mm256_xor_si256(z, sign);
  const Vector index = _mm256_srli_epi16(magnitude, 8);
  const Vector low = segment_ends(_mm256_unpacklo_epi16(index, zero()));
  const Vector high = segment_ends(_mm256_unpackhi_epi16(index, zero()));
  const Vector lower_half = _mm256_set1_epi32(0xFFFF);
  const Vector begin =
      _mm256_packus_epi32(_mm256_and_si256(low, lower_half), _mm256_and_si256(high, lower_half));
  const Vector end = _mm256_packus_epi32(_mm256_srli_epi32(low, 16), _mm256_srli_epi32(high, 16));
  const Vector rise = _mm256_sub_epi16(end, begin);
  const Vector y =
      _mm256_add_epi16(begin, _mm256_mulhi_epu16(rise, _mm256_slli_epi16(magnitude, 8)));
  return _mm256_xor_si256(y, sign);
}

#include "nn/batch/block_layers.inc"

}  // namespace

SCREED_NN_TARGET void run_block_avx2(const BlockLayer* layers, size_t count, const int16_t* in,
                                     int16_t* out, size_t stride) {
  all_layers(layers, count, in, out, stride);
}

SCREED_NN_TARGET void run_one_avx2(const LaneLayer* layers, size_t count, const int16_t* in,
                                   int16_t* out, size_t outputs) {
  all_layers_of_one(layers, count, in, out, outputs);
}

}  // namespace screed::nn
