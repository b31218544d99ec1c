// MCAP files.
#include "host_sim/ground_station/telemetry/mcap_file.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"

namespace screed {
namespace {

constexpr char kMagic[] = {'\x89', 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr size_t kChunkBytes = 1U << 20U;

// Kinds of records.
enum Opcode : uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

template <typename Number>
void put(std::string& out, Number value) {
  for (size_t i = 0; i < sizeof value; ++i) {
    out += static_cast<char>(static_cast<uint64_t>(value) >> (8 * i) & 0xFFU);
  }
}

void put_text(std::string& out, const std::string& text) {
  put(out, static_cast<uint32_t>(text.size()));
  out += text;
}

std::string record(Opcode opcode, const std::string& content) {
  std::string out;
  out.reserve(content.size() + 9);
  out += static_cast<char>(opcode);
  put(out, static_cast<uint64_t>(content.size()));
  return out + content;
}

uint32_t crc32_of(const std::string& bytes) {
  return static_cast<uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

std::string json_schema(const MessageInfo& message) {
  Json properties = Json::object();
  for (const SignalInfo& signal : message.signals) {
    if (signal.role != SignalRole::kData) continue;
    Json property;
    property["type"] = signal.flags[0] != '\0' ? "boolean"
                       : signal.values.empty() ? "number"
                                               : "string";
    std::string description = signal.unit;
    if (signal.comment[0] != '\0') {
      description += (description.empty() ? "" : "; ") + std::string(signal.comment);
    }
    if (!description.empty()) property["description"] = description;
    properties[signal.name] = property;
  }
  return Json{{"title", std::string("screed.") + message.title},
              {"description", message.comment},
              {"type", "object"},
              {"properties", properties}}
      .dump();
}

std::string json_of(const DecodedFrame& frame) {
  std::string text = "{";
  for (const SignalInfo& signal : frame.message->signals) {
    if (signal.role != SignalRole::kData) continue;
    const int64_t raw = signal.raw(frame.bits);
    if (text.size() > 1) text += ',';
    text += '"';
    text += signal.name;
    text += "\":";
    if (signal.flags[0] != '\0') {
      text += raw != 0 ? "true" : "false";
    } else if (signal.values.empty()) {
      text += signal.text(raw);
    } else {
      text += '"';
      text += signal.text(raw);
      text += '"';
    }
  }
  return text + "}";
}

}  // namespace

McapFile::McapFile(const std::string& path) : file_(path), has_schema_(messages().size(), false) {
  std::string header;
  put_text(header, "");  // no profile
  put_text(header, "screed");
  write(std::string(kMagic, sizeof kMagic) + record(kHeader, header));
}

void McapFile::write(const std::string& bytes) {
  file_.write(bytes);
  offset_ += bytes.size();
}

std::string McapFile::schema_record(uint16_t id, const MessageInfo& message) const {
  std::string content;
  put(content, id);
  put_text(content, std::string("screed.") + message.title);
  put_text(content, "jsonschema");
  put_text(content, json_schema(message));
  return record(kSchema, content);
}

std::string McapFile::channel_record(const Channel& channel) const {
  std::string content;
  put(content, channel.id);
  put(content, static_cast<uint16_t>(channel.message - messages().data() + 1));
  const std::string of =
      channel.node == 0 ? std::string("ground") : "robot" + std::to_string(channel.node);
  put_text(content, "/" + of + "/" + channel.message->title);
  put_text(content, "json");
  put(content, uint32_t{0});  // no metadata
  return record(kChannel, content);
}

McapFile::Channel& McapFile::channel_of(const DecodedFrame& frame) {
  const auto offset = static_cast<size_t>(frame.message - messages().data());
  const auto id = static_cast<uint16_t>(offset * 16 + frame.node + 1);
  Channel& channel = channels_[id];
  if (channel.message == nullptr) {
    channel.id = id;
    channel.message = frame.message;
    channel.node = frame.node;
    if (!has_schema_[offset]) {
      has_schema_[offset] = true;
      chunk_ += schema_record(static_cast<uint16_t>(offset + 1), *frame.message);
    }
    chunk_ += channel_record(channel);
  }
  return channel;
}

void McapFile::add(const DecodedFrame& frame) {
  const uint64_t time_ns = frame.time_us * 1000U;
  Channel& channel = channel_of(frame);
  first_ns_ = messages_ == 0 ? time_ns : std::min(first_ns_, time_ns);
  last_ns_ = std::max(last_ns_, time_ns);
  chunk_begin_ns_ = chunk_has_messages_ ? std::min(chunk_begin_ns_, time_ns) : time_ns;
  chunk_end_ns_ = chunk_has_messages_ ? std::max(chunk_end_ns_, time_ns) : time_ns;
  chunk_has_messages_ = true;
  put(channel.index, time_ns);
  put(channel.index, static_cast<uint64_t>(chunk_.size()));
  std::string content;
  put(content, channel.id);
  put(content, static_cast<uint32_t>(channel.messages));
  put(content, time_ns);
  put(content, time_ns);
  content += json_of(frame);
  chunk_ += record(kMessage, content);
  ++channel.messages;
  ++messages_;
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

void McapFile::end_chunk() {
  if (chunk_.empty()) return;
  ChunkEntry entry;
  entry.begin_ns = chunk_begin_ns_;
  entry.end_ns = chunk_end_ns_;
  entry.offset = offset_;
  entry.content_size = chunk_.size();
  std::string content;
  put(content, chunk_begin_ns_);
  put(content, chunk_end_ns_);
  put(content, static_cast<uint64_t>(chunk_.size()));
  put(content, crc32_of(chunk_));
  put_text(content, "");  // not compressed
  put(content, static_cast<uint64_t>(chunk_.size()));
  const std::string chunk_record = record(kChunk, content + chunk_);
  entry.size = chunk_record.size();
  write(chunk_record);
  for (auto& [id, channel] : channels_) {
    if (channel.index.empty()) continue;
    entry.channel_index[id] = offset_;
    std::string index;
    put(index, id);
    put_text(index, channel.index);
    write(record(kMessageIndex, index));
    channel.index.clear();
  }
  entry.index_size = offset_ - entry.offset - entry.size;
  chunks_.push_back(entry);
  chunk_.clear();
  chunk_has_messages_ = false;
}

void McapFile::finish() {
  end_chunk();
  write(record(kDataEnd, std::string(4, '\0')));  // no checksum of the data

  const uint64_t summary = offset_;
  std::string offsets;
  uint64_t group_begin = 0;
  const auto end_group = [&](Opcode opcode) {
    if (offset_ == group_begin) return;
    std::string content;
    content += static_cast<char>(opcode);
    put(content, group_begin);
    put(content, offset_ - group_begin);
    offsets += record(kSummaryOffset, content);
  };

  group_begin = offset_;
  for (size_t i = 0; i < has_schema_.size(); ++i) {
    if (has_schema_[i]) write(schema_record(static_cast<uint16_t>(i + 1), messages()[i]));
  }
  end_group(kSchema);

  group_begin = offset_;
  for (const auto& [id, channel] : channels_) write(channel_record(channel));
  end_group(kChannel);

  group_begin = offset_;
  std::string statistics;
  put(statistics, messages_);
  put(statistics, static_cast<uint16_t>(std::count(has_schema_.begin(), has_schema_.end(), true)));
  put(statistics, static_cast<uint32_t>(channels_.size()));
  put(statistics, uint32_t{0});  // attachments
  put(statistics, uint32_t{0});  // metadata
  put(statistics, static_cast<uint32_t>(chunks_.size()));
  put(statistics, first_ns_);
  put(statistics, last_ns_);
  std::string counts;
  for (const auto& [id, channel] : channels_) {
    put(counts, id);
    put(counts, channel.messages);
  }
  put_text(statistics, counts);
  write(record(kStatistics, statistics));
  end_group(kStatistics);

  group_begin = offset_;
  for (const ChunkEntry& chunk : chunks_) {
    std::string content;
    put(content, chunk.begin_ns);
    put(content, chunk.end_ns);
    put(content, chunk.offset);
    put(content, chunk.size);
    std::string index;
    for (const auto& [id, offset] : chunk.channel_index) {
      put(index, id);
      put(index, offset);
    }
    put_text(content, index);
    put(content, chunk.index_size);
    put_text(content, "");
    put(content, chunk.content_size);
    put(content, chunk.content_size);
    write(record(kChunkIndex, content));
  }
  end_group(kChunkIndex);

  const uint64_t summary_offsets = offset_;
  write(offsets);
  std::string footer;
  put(footer, summary);
  put(footer, summary_offsets);
  put(footer, uint32_t{0});  // no checksum of the summary
  write(record(kFooter, footer) + std::string(kMagic, sizeof kMagic));
  file_.commit();
}

}  // namespace screed
