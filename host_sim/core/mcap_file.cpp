// Records of MCAP files.
#include "host_sim/core/mcap_file.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr std::size_t kChunkBytes = 1U << 20U;
constexpr std::string_view kCompression = "zstd";

// Kinds of records.
enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

template <typename Number>
void put(std::string& out, Number value) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    out += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xFFU);
  }
}

void put_text(std::string& out, std::string_view text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

std::string record(Opcode opcode, std::string_view content) {
  std::string out;
  out.reserve(content.size() + 9);
  out += static_cast<char>(opcode);
  put(out, static_cast<std::uint64_t>(content.size()));
  out += content;
  return out;
}

std::uint32_t crc32_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string compressed(std::string_view bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size) != 0U) throw RunError(std::string("zstd: ") + ZSTD_getErrorName(size));
  out.resize(size);
  return out;
}

}  // namespace

void McapFile::Times::add(std::uint64_t time_ns) {
  begin_ns = any ? std::min(begin_ns, time_ns) : time_ns;
  end_ns = any ? std::max(end_ns, time_ns) : time_ns;
  any = true;
}

McapFile::McapFile(const std::filesystem::path& path) : file_(path) {
  std::string header;
  put_text(header, "");  // no profile
  put_text(header, "screed");
  write(kMagic);
  write(record(kHeader, header));
}

void McapFile::write(std::string_view bytes) {
  file_.write(bytes);
  offset_ += bytes.size();
}

McapFile::Id McapFile::add_schema(std::string_view name, std::string_view encoding,
                                  std::string_view text) {
  const auto id = static_cast<Id>(schemas_.size() + 1);
  std::string content;
  put(content, id);
  put_text(content, name);
  put_text(content, encoding);
  put_text(content, text);
  schemas_.push_back(record(kSchema, content));
  chunk_ += schemas_.back();
  return id;
}

McapFile::Id McapFile::add_channel(std::string_view topic, std::string_view encoding, Id schema) {
  const auto id = static_cast<Id>(channels_.size() + 1);
  std::string content;
  put(content, id);
  put(content, schema);
  put_text(content, topic);
  put_text(content, encoding);
  put(content, std::uint32_t{0});  // no metadata
  Channel channel;
  channel.record = record(kChannel, content);
  channels_.push_back(channel);
  chunk_ += channel.record;
  return id;
}

void McapFile::add_message(Id id, std::uint64_t time_ns, std::string_view content) {
  Channel& channel = channels_.at(id - 1U);
  chunk_times_.add(time_ns);
  times_.add(time_ns);
  put(channel.index, time_ns);
  put(channel.index, static_cast<std::uint64_t>(chunk_.size()));
  constexpr std::size_t kPrefixBytes = 22;
  chunk_ += static_cast<char>(kMessage);
  put(chunk_, static_cast<std::uint64_t>(kPrefixBytes + content.size()));
  put(chunk_, id);
  put(chunk_, static_cast<std::uint32_t>(channel.messages));
  put(chunk_, time_ns);
  put(chunk_, time_ns);
  chunk_ += content;
  ++channel.messages;
  ++messages_;
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

void McapFile::add_message(Id channel, std::uint64_t time_ns,
                           std::span<const std::uint8_t> content) {
  add_message(channel, time_ns,
              std::string_view(reinterpret_cast<const char*>(content.data()), content.size()));
}

void McapFile::end_chunk() {
  if (chunk_.empty()) return;
  const std::uint64_t begin = offset_;
  const std::string packed = compressed(chunk_);
  std::string content;
  put(content, chunk_times_.begin_ns);
  put(content, chunk_times_.end_ns);
  put(content, static_cast<std::uint64_t>(chunk_.size()));
  put(content, crc32_of(chunk_));
  put_text(content, kCompression);
  put(content, static_cast<std::uint64_t>(packed.size()));
  write(record(kChunk, content + packed));

  const std::uint64_t end = offset_;
  std::string places;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].index.empty()) continue;
    put(places, static_cast<Id>(i + 1));
    put(places, offset_);
    std::string index;
    put(index, static_cast<Id>(i + 1));
    put_text(index, channels_[i].index);
    write(record(kMessageIndex, index));
    channels_[i].index.clear();
  }

  std::string entry;
  put(entry, chunk_times_.begin_ns);
  put(entry, chunk_times_.end_ns);
  put(entry, begin);
  put(entry, end - begin);
  put_text(entry, places);
  put(entry, offset_ - end);
  put_text(entry, kCompression);
  put(entry, static_cast<std::uint64_t>(packed.size()));
  put(entry, static_cast<std::uint64_t>(chunk_.size()));
  chunk_indices_ += record(kChunkIndex, entry);
  ++chunks_;
  chunk_.clear();
  chunk_times_ = {};
}

void McapFile::add_attachment(std::string_view name, std::string_view media_type,
                              std::string_view content) {
  std::string attachment;
  put(attachment, std::uint64_t{0});  // of no time in the run
  put(attachment, std::uint64_t{0});  // nor of the day: the same run gives the same bytes
  put_text(attachment, name);
  put_text(attachment, media_type);
  put(attachment, static_cast<std::uint64_t>(content.size()));
  attachment += content;
  put(attachment, crc32_of(attachment));
  const std::string bytes = record(kAttachment, attachment);

  std::string index;
  put(index, offset_);
  put(index, static_cast<std::uint64_t>(bytes.size()));
  put(index, std::uint64_t{0});
  put(index, std::uint64_t{0});
  put(index, static_cast<std::uint64_t>(content.size()));
  put_text(index, name);
  put_text(index, media_type);
  attachment_indices_ += record(kAttachmentIndex, index);
  ++attachments_;
  write(bytes);
}

void McapFile::add_metadata(std::string_view name,
                            const std::map<std::string, std::string>& entries) {
  std::string pairs;
  for (const auto& [key, value] : entries) {
    put_text(pairs, key);
    put_text(pairs, value);
  }
  std::string metadata;
  put_text(metadata, name);
  put_text(metadata, pairs);
  const std::string bytes = record(kMetadata, metadata);

  std::string index;
  put(index, offset_);
  put(index, static_cast<std::uint64_t>(bytes.size()));
  put_text(index, name);
  metadata_indices_ += record(kMetadataIndex, index);
  ++metadata_;
  write(bytes);
}

std::string McapFile::statistics() const {
  std::string content;
  put(content, messages_);
  put(content, static_cast<std::uint16_t>(schemas_.size()));
  put(content, static_cast<std::uint32_t>(channels_.size()));
  put(content, attachments_);
  put(content, metadata_);
  put(content, chunks_);
  put(content, times_.begin_ns);
  put(content, times_.end_ns);
  std::string counts;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    put(counts, static_cast<Id>(i + 1));
    put(counts, channels_[i].messages);
  }
  put_text(content, counts);
  return record(kStatistics, content);
}

void McapFile::finish() {
  end_chunk();
  write(record(kDataEnd, std::string(4, '\0')));  // no checksum of the data

  const std::uint64_t begin = offset_;
  std::string schemas;
  for (const std::string& schema : schemas_) schemas += schema;
  std::string channels;
  for (const Channel& channel : channels_) channels += channel.record;
  std::string summary;
  std::string offsets;
  for (const SummaryGroup& group : {SummaryGroup{kSchema, schemas},
                                    {kChannel, channels},
                                    {kStatistics, statistics()},
                                    {kChunkIndex, chunk_indices_},
                                    {kAttachmentIndex, attachment_indices_},
                                    {kMetadataIndex, metadata_indices_}}) {
    if (group.records.empty()) continue;
    std::string content;
    put(content, group.opcode);
    put(content, begin + summary.size());
    put(content, static_cast<std::uint64_t>(group.records.size()));
    offsets += record(kSummaryOffset, content);
    summary += group.records;
  }

  // The checksum covers all up to itself.
  const std::uint64_t begin_of_offsets = begin + summary.size();
  summary += offsets;
  constexpr std::uint64_t kFooterBytes = 20;
  std::string footer;
  footer += static_cast<char>(kFooter);
  put(footer, kFooterBytes);
  put(footer, begin);
  put(footer, begin_of_offsets);
  summary += footer;
  put(summary, crc32_of(summary));
  write(summary);
  write(kMagic);
  file_.commit();
}

}  // namespace screed
