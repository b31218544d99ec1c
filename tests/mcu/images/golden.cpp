// Test image: computes the golden vectors on the MCU and sends them.
#include "tests/mcu/golden_vectors.h"
#include "tests/mcu/images/image_link.h"

int main() {
  screed::ImageLink link;
  for (uint8_t section = 0; section < screed::kGoldenSections; ++section) {
    screed::golden_section(section, link);
  }
  link.stop();
}
