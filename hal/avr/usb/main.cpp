// The program of an image without the Arduino core.
#include "firmware/main_loop.h"

int main() {
  screed::main_loop();
  __builtin_unreachable();  // it never returns
}
