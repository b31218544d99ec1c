// tiny-dnn as every file that uses it must include it: one set of switches.
#pragma once

#define CNN_SINGLE_THREAD     // threads are ours, a network each
#define CNN_NO_SERIALIZATION  // checkpoints are ours too

// It brings its own copy of stb's functions into every file; they stay there.
#define STB_IMAGE_STATIC
#define STB_IMAGE_RESIZE_STATIC
#define STB_IMAGE_WRITE_STATIC

#include <tiny_dnn/tiny_dnn.h>
