// The XBee's API mode.
#include "host_sim/ground_station/link/xbee_api.h"

#include <algorithm>
#include <numeric>

namespace screed {
namespace {

constexpr uint8_t kStart = 0x7E;
constexpr uint8_t kEscape = 0x7D;
constexpr uint8_t kEscapeXor = 0x20;
constexpr uint8_t kXon = 0x11;
constexpr uint8_t kXoff = 0x13;
constexpr size_t kHeader = 3;  // start byte and length
/// Asks for no transmit status: a frame id of 0.
constexpr uint8_t kNoStatus = 0;

uint8_t checksum(std::span<const uint8_t> bytes) {
  return static_cast<uint8_t>(0xFF - std::accumulate(bytes.begin(), bytes.end(), 0U) % 256U);
}

uint64_t big_endian(std::span<const uint8_t> bytes) {
  return std::accumulate(bytes.begin(), bytes.end(), uint64_t{0},
                         [](uint64_t value, uint8_t byte) { return value << 8U | byte; });
}

}  // namespace

void XbeeApiParser::feed(uint8_t byte, std::vector<XbeeFrame>& frames) {
  if (mode_ == XbeeApiMode::kEscaped) {
    if (byte == kStart) {  // never inside a frame: the one in hand was cut
      if (!bytes_.empty()) ++refused_;
      bytes_ = {kStart};
      escape_ = false;
      return;
    }
    if (byte == kEscape) {
      escape_ = true;
      return;
    }
    if (escape_) byte = static_cast<uint8_t>(byte ^ kEscapeXor);
    escape_ = false;
  }
  process(byte, frames);
}

void XbeeApiParser::process(uint8_t byte, std::vector<XbeeFrame>& frames) {
  if (bytes_.empty() && byte != kStart) return;  // between frames
  bytes_.push_back(byte);
  if (bytes_.size() < kHeader) return;
  const size_t length = static_cast<size_t>(bytes_[1]) << 8U | bytes_[2];
  if (length == 0 || length > kXbeeMaxContent + 1) return start_again(frames);
  if (bytes_.size() < kHeader + length + 1) return;
  const std::span<const uint8_t> body(bytes_.data() + kHeader, length);
  if (checksum(body) != bytes_.back()) return start_again(frames);
  frames.push_back({static_cast<XbeeFrameType>(body[0]), {body.begin() + 1, body.end()}});
  bytes_.clear();
}

/// The start byte was none, or the frame is damaged: looks for another start in what is in hand.
void XbeeApiParser::start_again(std::vector<XbeeFrame>& frames) {
  ++refused_;
  const std::vector<uint8_t> rest(bytes_.begin() + 1, bytes_.end());
  bytes_.clear();
  if (mode_ == XbeeApiMode::kEscaped) return;  // an unescaped 0x7E in it is data
  for (const uint8_t byte : rest) process(byte, frames);
}

std::vector<uint8_t> encode_xbee(const XbeeFrame& frame, XbeeApiMode mode) {
  std::vector<uint8_t> body = {static_cast<uint8_t>(frame.type)};
  body.insert(body.end(), frame.content.begin(), frame.content.end());
  std::vector<uint8_t> plain = {static_cast<uint8_t>(body.size() >> 8U),
                                static_cast<uint8_t>(body.size() & 0xFFU)};
  plain.insert(plain.end(), body.begin(), body.end());
  plain.push_back(checksum(body));

  std::vector<uint8_t> line = {kStart};
  for (const uint8_t byte : plain) {
    const bool special = byte == kStart || byte == kEscape || byte == kXon || byte == kXoff;
    if (special && mode == XbeeApiMode::kEscaped) {
      line.push_back(kEscape);
      line.push_back(static_cast<uint8_t>(byte ^ kEscapeXor));
    } else {
      line.push_back(byte);
    }
  }
  return line;
}

std::optional<XbeePacket> received_packet(const XbeeFrame& frame) {
  // Bytes of the address, and where data and RSSI stand.
  struct Layout {
    size_t address_bytes;
    size_t data_at;
    XbeeFrameType type;
    bool rssi;  ///< behind the address
  };
  constexpr Layout kLayouts[] = {
      {8, 10, XbeeFrameType::kReceive64, true},
      {2, 4, XbeeFrameType::kReceive16, true},
      {8, 11, XbeeFrameType::kReceive, false},
      {8, 17, XbeeFrameType::kReceiveExplicit, false},
  };
  const auto* const layout = std::find_if(std::begin(kLayouts), std::end(kLayouts),
                                          [&](const Layout& l) { return l.type == frame.type; });
  if (layout == std::end(kLayouts) || frame.content.size() < layout->data_at) return std::nullopt;
  XbeePacket packet;
  packet.source.address = big_endian(std::span(frame.content).first(layout->address_bytes));
  if (layout->rssi) packet.source.rssi_dbm = -int{frame.content[layout->address_bytes]};
  packet.data.assign(frame.content.begin() + static_cast<std::ptrdiff_t>(layout->data_at),
                     frame.content.end());
  return packet;
}

std::optional<bool> delivered(const XbeeFrame& frame) {
  // 0x89: frame id, status; 0x8B: frame id, address of 2 bytes, retries, status, discovery.
  if (frame.type == XbeeFrameType::kTransmitStatusPlain && frame.content.size() >= 2)
    return frame.content[1] == 0;
  if (frame.type == XbeeFrameType::kTransmitStatus && frame.content.size() >= 6)
    return frame.content[4] == 0;
  return std::nullopt;
}

std::optional<int> answered_rssi_dbm(const XbeeFrame& frame) {
  // Frame id, two letters, status, value.
  if (frame.type != XbeeFrameType::kCommandResponse || frame.content.size() < 5)
    return std::nullopt;
  if (frame.content[1] != 'D' || frame.content[2] != 'B' || frame.content[3] != 0)
    return std::nullopt;
  return -int{frame.content.back()};
}

XbeeFrame broadcast_request(std::span<const uint8_t> data, XbeeFrameType like) {
  XbeeFrame request;
  constexpr uint8_t kBroadcast64[] = {0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
  request.content = {kNoStatus};
  if (like == XbeeFrameType::kReceive64 || like == XbeeFrameType::kReceive16) {
    request.type = XbeeFrameType::kTransmit64;
    request.content.insert(request.content.end(), std::begin(kBroadcast64), std::end(kBroadcast64));
    request.content.push_back(0);  // options
  } else {
    request.type = XbeeFrameType::kTransmit;
    request.content.insert(request.content.end(), std::begin(kBroadcast64), std::end(kBroadcast64));
    request.content.insert(request.content.end(),
                           {0xFF, 0xFE, 0, 0});  // 16-bit address, radius, options
  }
  request.content.insert(request.content.end(), data.begin(), data.end());
  return request;
}

}  // namespace screed
