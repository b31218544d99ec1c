// Packets of an XBee module in API mode. The first byte chooses the mode.
#include <cstdint>
#include <vector>

#include "host_sim/ground_station/link/xbee_api.h"
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  if (size == 0) return 0;
  const screed::XbeeApiMode mode =
      (bytes[0] & 1U) != 0 ? screed::XbeeApiMode::kPlain : screed::XbeeApiMode::kEscaped;
  screed::XbeeApiParser parser(mode);
  std::vector<screed::XbeeFrame> frames;
  for (size_t i = 1; i < size; ++i) parser.feed(bytes[i], frames);
  for (const screed::XbeeFrame& frame : frames) {
    SCREED_REQUIRE(frame.content.size() <= screed::kXbeeMaxContent);
    screed::received_packet(frame);
    screed::delivered(frame);
    screed::answered_rssi_dbm(frame);
    // What was read is read again from its own bytes.
    screed::XbeeApiParser again(mode);
    std::vector<screed::XbeeFrame> copies;
    for (const uint8_t byte : screed::encode_xbee(frame, mode)) again.feed(byte, copies);
    SCREED_REQUIRE(copies.size() == 1 && copies[0].type == frame.type &&
                   copies[0].content == frame.content);
  }
  return 0;
}
