// Decoded messages as an MCAP file, which Foxglove and its libraries open: a topic a message of a
// robot ("/robot1/attitude"), messages as JSON with a JSON schema that holds units and comments.
//
// Source: "MCAP Format Specification", version 0 (mcap.dev). Chunks are not compressed; chunks,
// messages and statistics are indexed, so that readers can seek.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host_sim/core/atomic_file.h"
#include "host_sim/ground_station/telemetry/candump_log.h"

namespace screed {

class McapFile {
 public:
  /// Throws RunError when the file cannot be written, here and in every other function.
  explicit McapFile(const std::string& path);

  void add(const DecodedFrame& frame);

  /// Index and end of the file, which has its name from then on; nothing may be added afterwards.
  void finish();

 private:
  struct Channel {
    uint16_t id = 0;
    const MessageInfo* message = nullptr;
    uint8_t node = 0;
    uint64_t messages = 0;
    std::string index;  ///< of the chunk under way: time and place of each message
  };
  struct ChunkEntry {
    uint64_t begin_ns = 0;
    uint64_t end_ns = 0;
    uint64_t offset = 0;
    uint64_t size = 0;
    uint64_t index_size = 0;
    uint64_t content_size = 0;
    std::map<uint16_t, uint64_t> channel_index;  ///< channel: place of its index
  };

  Channel& channel_of(const DecodedFrame& frame);
  void end_chunk();
  void write(const std::string& bytes);
  [[nodiscard]] std::string schema_record(uint16_t id, const MessageInfo& message) const;
  [[nodiscard]] std::string channel_record(const Channel& channel) const;

  AtomicFile file_;
  uint64_t offset_ = 0;  ///< bytes written
  std::map<uint16_t, Channel> channels_;
  std::vector<bool> has_schema_;  ///< by the message's place in the schema
  std::string chunk_;             ///< records of the chunk under way
  bool chunk_has_messages_ = false;
  uint64_t chunk_begin_ns_ = 0;
  uint64_t chunk_end_ns_ = 0;
  std::vector<ChunkEntry> chunks_;
  uint64_t messages_ = 0;
  uint64_t first_ns_ = 0;
  uint64_t last_ns_ = 0;
};

}  // namespace screed
