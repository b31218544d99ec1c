// The firmware's line parser, and what host programs do with a frame: any bytes at all.
#include <cctype>
#include <cstdint>
#include <cstring>

#include "host_sim/ground_station/telemetry/schema.h"
#include "tests/fuzz/require.h"

namespace {

/// A line that gave a frame is that frame's line, but for the case of its letters.
void require_line_of(const uint8_t* end, size_t before, const screed::CanFrame& frame) {
  uint8_t line[screed::kSlcanLineMax];
  const uint8_t length = screed::slcan_encode(frame, line);
  SCREED_REQUIRE(length <= screed::kSlcanLineMax && length <= before);
  const uint8_t* const begin = end - length;
  SCREED_REQUIRE(begin[0] == 't');
  for (uint8_t i = 1; i < length; ++i) SCREED_REQUIRE(std::toupper(begin[i]) == line[i]);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  screed::SlcanParser parser;
  screed::CanFrame frame{};
  for (size_t i = 0; i < size; ++i) {
    if (!parser.feed(bytes[i], frame)) continue;
    SCREED_REQUIRE(frame.size <= 8 && frame.id <= 0x7FF);
    require_line_of(bytes + i + 1, i + 1, frame);
    const screed::FrameFault fault = screed::check_frame(frame);
    const screed::MessageInfo* const message = screed::find_message(frame.id);
    SCREED_REQUIRE((message == nullptr) == (fault == screed::FrameFault::kUnknownId));
    if (message == nullptr) continue;
    for (const screed::SignalInfo& signal : message->signals) {
      const int64_t raw = signal.raw(frame.data);
      SCREED_REQUIRE(!signal.text(raw).empty());
      SCREED_REQUIRE(signal.value(raw) == signal.value(raw));
    }
  }
  return 0;
}
