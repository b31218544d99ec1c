// Model slip: what the chassis makes of the tracks' speed, for the robot's slip watch
// Written by `screed nn export`; training data 5cca6c8d63001f4e2541ba77c8124c60, seed 1.
#pragma once

// clang-format off
#include "nn/infer/dense.h"
#include "nn/infer/program_memory.h"

namespace screed {
namespace nn {
namespace model_slip {

const uint8_t speed_share_parameters[] SCREED_NN_PROGRAM_MEMORY = {
    177, 217, 224, 5, 159, 121, 32, 109, 167, 135, 5, 108, 130, 147, 249, 137,
    130, 212, 226, 242, 130, 145, 23, 110, 240, 144, 2, 139, 239, 128, 73, 122,
    28, 165, 173, 25, 44, 115, 85, 114, 183, 124, 235, 138, 162, 114, 207, 110,
    77, 48, 218, 234, 17, 114, 94, 133, 166, 130, 9, 149, 115, 135, 177, 144,
    162, 169, 175, 251, 1, 128, 196, 110, 211, 135, 254, 136, 170, 134, 40, 127,
    156, 196, 169, 27, 91, 141, 42, 126, 118, 113, 154, 123, 79, 111, 141, 99,
    145, 87, 136, 200, 145, 126, 195, 252, 54, 114, 209, 141, 106, 140, 189, 115,
    102, 200, 95, 29, 34, 112, 255, 109, 234, 106, 204, 130, 158, 117, 129, 133,
    116, 187, 122, 216, 254, 136, 98, 119, 34, 166, 29, 93, 27, 112, 41, 172,
    77, 157, 161, 150,
};

/// in:  inertial_slip = 0 + 2 (q + 1/2) / 2^15
/// in:  turn = 0 + 2 (q + 1/2) / 2^15
/// in:  track_difference = 0 + 2 (q + 1/2) / 2^15
/// in:  faster_track = 0 + 0.4096 (q + 1/2) / 2^15
/// in:  sin_pitch = 0 + 2 (q + 1/2) / 2^15
/// in:  effort = 0 + 512 (q + 1/2) / 2^15
/// out: speed_share = 0 + 2 (q + 1/2) / 2^15
inline void run_speed_share(const int16_t* in, int16_t* out) {
  int16_t a[8];
  dense<6, 8, 67>(speed_share_parameters + 0, in, a);
  dense<8, 1, 66>(speed_share_parameters + 128, a, out);
}

constexpr uint8_t k_speed_share_inputs = 6;
constexpr uint8_t k_speed_share_outputs = 1;
constexpr uint8_t k_speed_share_golden_vectors = 12;
const int16_t speed_share_golden_in[] SCREED_NN_PROGRAM_MEMORY = {
    -32768, -32768, -32768, -32768, -32768, -32768, -1, -1, -1, -1, -1, -1, 0, 0, 0, 0,
    0, 0, 32767, 32767, 32767, 32767, 32767, 32767, -26037, -21161, -2689, 16049, -11391, -27250, -23213, 28947,
    17106, 11393, -2611, -13179, -9704, -5163, -2157, -18289, 31652, 5096, -23436, 3570, 986, -10193, 16908, -8113,
    -9010, 27571, 26436, 18395, 1359, 6341, 21510, 29933, 11518, 20919, -9214, -7393, -20686, 10332, -19897, 18747,
    23561, -5287, -7662, -13009, -14429, -22933, 12413, 10989,
};
const int16_t speed_share_golden_out[] SCREED_NN_PROGRAM_MEMORY = {
    32767, 15613, 15612, -32768, 30002, 9980, -12813, 21306, -23614, 9788, 13202, -1229,
};

}  // namespace model_slip
}  // namespace nn
}  // namespace screed
