// MCAP files, which Foxglove, Lichtblick, PlotJuggler and their libraries open: topics of messages
// with a time, and beside them attachments and metadata.
//
// Source: "MCAP Format Specification", version 0 (mcap.dev). Chunks are compressed by zstd;
// messages, chunks, attachments and metadata are indexed, so that readers can seek.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/core/atomic_file.h"

namespace screed {

class McapFile {
 public:
  using Id = std::uint16_t;

  /// Throws RunError when the file cannot be written, here and in every other function.
  explicit McapFile(const std::filesystem::path& path);

  /// How messages are described: `encoding` as the specification's registry names it, "jsonschema"
  /// or "ros1msg".
  Id add_schema(std::string_view name, std::string_view encoding, std::string_view text);
  /// A topic, whose messages are encoded in "json" or "ros1".
  Id add_channel(std::string_view topic, std::string_view encoding, Id schema);
  /// Messages may come in any order of time; in order they are read fastest.
  void add_message(Id channel, std::uint64_t time_ns, std::string_view content);
  void add_message(Id channel, std::uint64_t time_ns, std::span<const std::uint8_t> content);

  void add_attachment(std::string_view name, std::string_view media_type, std::string_view content);
  void add_metadata(std::string_view name, const std::map<std::string, std::string>& entries);

  /// Index and end of the file, which has its name from then on; nothing may be added afterwards.
  void finish();

 private:
  struct Channel {
    std::string record;
    std::uint64_t messages = 0;
    std::string index;  ///< of the chunk under way: time and place of each message
  };
  struct Times {
    std::uint64_t begin_ns = 0;
    std::uint64_t end_ns = 0;
    bool any = false;
    void add(std::uint64_t time_ns);
  };
  /// A kind of record in the summary, and its records.
  struct SummaryGroup {
    std::uint8_t opcode;
    std::string records;
  };

  void end_chunk();
  void write(std::string_view bytes);
  std::string statistics() const;

  AtomicFile file_;
  std::uint64_t offset_ = 0;          ///< bytes written
  std::vector<std::string> schemas_;  ///< their records; a schema's id is its place, from 1
  std::vector<Channel> channels_;     ///< likewise
  std::string chunk_;                 ///< records of the chunk under way
  Times chunk_times_;
  Times times_;
  std::uint64_t messages_ = 0;
  std::string chunk_indices_;
  std::string attachment_indices_;
  std::string metadata_indices_;
  std::uint32_t chunks_ = 0;
  std::uint32_t attachments_ = 0;
  std::uint32_t metadata_ = 0;
};

}  // namespace screed
