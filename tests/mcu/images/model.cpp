// Test image: a model as `screed nn export` writes it. Sends for each network how many golden
// vectors it has and how many of them come out otherwise.
#include "models/v1.h"
#include "tests/mcu/images/image_link.h"

namespace {

using namespace screed;

template <uint8_t kInputs, uint8_t kOutputs>
void check(ImageLink& link, uint8_t vectors, const int16_t* golden_in, const int16_t* golden_out,
           void (*run)(const int16_t*, int16_t*)) {
  uint8_t wrong = 0;
  for (uint8_t vector = 0; vector < vectors; ++vector) {
    int16_t in[kInputs];
    int16_t out[kOutputs];
    for (uint8_t i = 0; i < kInputs; ++i) in[i] = read_program_i16(golden_in++);
    run(in, out);
    bool equal = true;
    for (uint8_t i = 0; i < kOutputs; ++i) {
      equal = read_program_i16(golden_out++) == out[i] && equal;
    }
    if (!equal) ++wrong;
  }
  link.put(vectors);
  link.put(wrong);
}

}  // namespace

int main() {
  using namespace nn::model_v1;
  ImageLink link;
  check<k_v_inputs, k_v_outputs>(link, k_v_golden_vectors, v_golden_in, v_golden_out, run_v);
  check<k_delta_theta_inputs, k_delta_theta_outputs>(link, k_delta_theta_golden_vectors,
                                                     delta_theta_golden_in, delta_theta_golden_out,
                                                     run_delta_theta);
  link.stop();
}
