#include "nn/infer/tanh_table.h"

// The assembly of dense_avr.cpp is a user that link-time optimisation does not see.
#ifdef __AVR__
// In a section of its own, so that it goes when no kernel that needs it is linked.
#define SCREED_NN_SEEN_BY_ASSEMBLY \
  __attribute__((used, externally_visible, section(".progmem.data.screed_nn_tanh_table")))
#else
#define SCREED_NN_SEEN_BY_ASSEMBLY
#endif

namespace screed {
namespace nn {

extern "C" const int16_t screed_nn_tanh_table[129] SCREED_NN_SEEN_BY_ASSEMBLY = {
    2,     1026,  2047,  3065,  4077,  5081,  6075,  7058,  8028,  8983,  9922,  10843, 11745,
    12628, 13489, 14329, 15145, 15939, 16709, 17455, 18176, 18872, 19545, 20192, 20815, 21414,
    21989, 22540, 23068, 23573, 24056, 24517, 24958, 25378, 25778, 26158, 26521, 26865, 27192,
    27503, 27798, 28077, 28342, 28593, 28831, 29056, 29269, 29470, 29661, 29841, 30010, 30171,
    30322, 30465, 30600, 30727, 30847, 30961, 31067, 31168, 31262, 31352, 31436, 31515, 31589,
    31660, 31726, 31788, 31846, 31901, 31953, 32002, 32048, 32091, 32132, 32170, 32206, 32240,
    32271, 32301, 32329, 32356, 32381, 32404, 32426, 32446, 32466, 32484, 32501, 32517, 32532,
    32547, 32560, 32572, 32584, 32595, 32606, 32616, 32625, 32633, 32642, 32649, 32656, 32663,
    32669, 32675, 32681, 32686, 32691, 32696, 32700, 32704, 32708, 32712, 32715, 32718, 32721,
    32724, 32727, 32729, 32732, 32734, 32736, 32738, 32740, 32741, 32743, 32744, 32746,
};

}  // namespace nn
}  // namespace screed
