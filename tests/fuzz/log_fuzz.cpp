// The reader of logs, with a buffer so small that lines meet its end, and a line read on its own.
#include <cstdint>
#include <cstring>
#include <string_view>

#include "host_sim/ground_station/telemetry/candump_log.h"
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  screed::LoggedFrame logged;
  if (screed::parse_candump_line(text, logged) == screed::LineKind::kFrame) {
    // What is written of a frame is read as the same.
    const std::string line = screed::candump_line(logged.time_us, "can0", logged.frame);
    screed::LoggedFrame again;
    SCREED_REQUIRE(screed::parse_candump_line(std::string_view(line).substr(0, line.size() - 1),
                                              again) == screed::LineKind::kFrame);
    SCREED_REQUIRE(again.time_us == logged.time_us && again.frame.id == logged.frame.id &&
                   again.frame.size == logged.frame.size &&
                   std::memcmp(again.frame.data, logged.frame.data, 8) == 0);
  }
  if (size == 0) return 0;
  std::FILE* const file = fmemopen(const_cast<uint8_t*>(bytes), size, "rb");
  SCREED_REQUIRE(file != nullptr);
  screed::LogDecoder decoder(screed::CandumpReader("fuzz", file, 64));
  screed::DecodedFrame frame;
  uint64_t messages = 0;
  while (decoder.next(frame)) ++messages;
  const screed::DecodeStatistics& statistics = decoder.statistics();
  SCREED_REQUIRE(statistics.messages == messages);
  SCREED_REQUIRE(statistics.lines == messages + statistics.damaged() + statistics.unknown_ids +
                                         statistics.other_frames);
  SCREED_REQUIRE(!statistics.text().empty());
  return 0;
}
