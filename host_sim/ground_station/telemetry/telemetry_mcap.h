// Decoded messages as an MCAP file: a topic a message of a robot ("/robot1/attitude"), messages as
// JSON with a JSON schema that holds units and comments.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <utility>

#include "host_sim/core/mcap_file.h"
#include "host_sim/ground_station/telemetry/candump_log.h"

namespace screed {

class TelemetryMcap {
 public:
  /// Throws RunError when the file cannot be written, here and in every other function.
  explicit TelemetryMcap(const std::filesystem::path& path) : file_(path) {}

  void add(const DecodedFrame& frame);
  /// The file has its name from then on; nothing may be added afterwards.
  void finish() { file_.finish(); }

 private:
  McapFile::Id channel_of(const DecodedFrame& frame);

  McapFile file_;
  std::map<const MessageInfo*, McapFile::Id> schemas_;  // looked up, never walked through
  std::map<std::pair<const MessageInfo*, std::uint8_t>, McapFile::Id> channels_;
};

}  // namespace screed
