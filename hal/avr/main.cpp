// Start of the program on the ATmega32U4.
#include "firmware/main_loop.h"

int main() {
  screed::main_loop();
}
