// The program as an Arduino sketch: the core's main() sets up the board and USB and calls these. In
// the Arduino library the example sketch takes the place of this file.
#include <Arduino.h>

#include "firmware/main_loop.h"

void setup() {
  screed::main_loop();
  __builtin_unreachable();  // it never returns: nothing of the core's loop is left in the image
}

void loop() {}
