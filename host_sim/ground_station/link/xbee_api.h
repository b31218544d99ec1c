// The XBee's API mode: frames of bytes with type, address and checksum, instead of a plain stream.
// A receiver learns from them which module sent a packet and how strong it was.
//
//   0x7E | length, 2 bytes, high first | type and content | 0xFF - sum of type and content
//
// In API mode 2 (parameter AP = 2) every 0x7E, 0x7D, 0x11 and 0x13 after the first byte travels as
// 0x7D and the byte xor 0x20. Source: Digi, "XBee/XBee-PRO RF Modules 802.15.4 Product Manual"
// (90000982) and "XBee/XBee-PRO S2C Zigbee User Guide" (90002002), API operation.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/ground_station/link/link.h"

namespace screed {

enum class XbeeApiMode {
  kPlain = 1,    ///< AP = 1
  kEscaped = 2,  ///< AP = 2
};

enum class XbeeFrameType : uint8_t {
  kTransmit64 = 0x00,           ///< 802.15.4: 64-bit address
  kTransmit16 = 0x01,           ///< 802.15.4: 16-bit address
  kTransmit = 0x10,             ///< Zigbee and DigiMesh
  kReceive64 = 0x80,            ///< 802.15.4, with RSSI
  kReceive16 = 0x81,            ///< 802.15.4, with RSSI
  kCommandResponse = 0x88,      ///< answer to an AT command
  kTransmitStatusPlain = 0x89,  ///< 802.15.4
  kModemStatus = 0x8A,
  kTransmitStatus = 0x8B,  ///< Zigbee and DigiMesh
  kReceive = 0x90,         ///< Zigbee and DigiMesh; no RSSI
  kReceiveExplicit = 0x91,
};

struct XbeeFrame {
  XbeeFrameType type{};
  std::vector<uint8_t> content;  ///< without the type
};

/// Longest content that is believed; the modules send at most 256 bytes of data.
constexpr size_t kXbeeMaxContent = 320;

/// Bytes to frames. What is damaged is dropped and counted, and the next start byte begins anew.
class XbeeApiParser {
 public:
  explicit XbeeApiParser(XbeeApiMode mode) : mode_(mode) {}

  /// Takes one byte; appends the frames it completed (more than one only after damage).
  void feed(uint8_t byte, std::vector<XbeeFrame>& frames);

  uint64_t refused() const { return refused_; }

 private:
  void process(uint8_t byte, std::vector<XbeeFrame>& frames);
  void start_again(std::vector<XbeeFrame>& frames);

  XbeeApiMode mode_;
  std::vector<uint8_t> bytes_;  ///< of the current frame, from its start byte, unescaped
  bool escape_ = false;
  uint64_t refused_ = 0;
};

/// The bytes of a frame, as they go over the serial line.
std::vector<uint8_t> encode_xbee(const XbeeFrame& frame, XbeeApiMode mode);

/// Data that a module has received from another one.
struct XbeePacket {
  RadioSource source;
  std::vector<uint8_t> data;
};
/// Nothing for frames of other types and for such as are too short.
std::optional<XbeePacket> received_packet(const XbeeFrame& frame);

/// A transmit status: true when the packet was delivered; nothing for frames of other types.
std::optional<bool> delivered(const XbeeFrame& frame);

/// The RSSI in an answer to the AT command DB: how modules without it in their packets report it.
std::optional<int> answered_rssi_dbm(const XbeeFrame& frame);

/// A request to send data, in the frame type of modules that speak `like` (a receive type), to all.
XbeeFrame broadcast_request(std::span<const uint8_t> data, XbeeFrameType like);

}  // namespace screed
