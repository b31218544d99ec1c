// Test image: the network's layers. Sends the hash of every block of vectors, and drives PD4 high
// while a network of the thesis' shapes runs, so that the simulator can count its cycles.
#include "tests/mcu/images/image_link.h"
#include "tests/mcu/network_parameters.h"
#include "tests/mcu/network_vectors.h"

namespace {

void put(screed::ImageLink& link, uint32_t hash) {
  for (uint8_t byte = 0; byte < 4; ++byte) link.put(static_cast<uint8_t>(hash >> (8 * byte)));
}

}  // namespace

int main() {
  screed::ImageLink link;
  DDRD |= _BV(DDD4);
  const int16_t in[4] = {12345, -23456, 32767, -32768};
  volatile int16_t sink;
  PORTD |= _BV(PORTD4);
  sink = screed::small_network(screed::kParameters, in);
  PORTD &= static_cast<uint8_t>(~_BV(PORTD4));
  PORTD |= _BV(PORTD4);
  sink = screed::deep_network(screed::kParameters, in);
  PORTD &= static_cast<uint8_t>(~_BV(PORTD4));
  (void)sink;

  for (uint16_t block = 0; block < screed::kNetworkBlocks; ++block) {
    put(link, screed::network_vectors_hash(block + 1UL, screed::kVectorsPerBlock));
  }
  for (uint16_t block = 0; block < 256; ++block) {
    put(link, screed::tanh_hash(static_cast<uint16_t>(block << 8)));
  }
  for (uint16_t block = 0; block < screed::kGatedBlocks; ++block) {
    put(link, screed::gated_hash(block + 1UL));
  }
  link.stop();
}
