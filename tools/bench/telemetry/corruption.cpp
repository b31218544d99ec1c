// Frames of the schema with random content, and damaged lines of them.
#include "tools/bench/telemetry/corruption.h"

#include <algorithm>
#include <cstring>

#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "firmware/security/command_mac.h"

namespace screed {
namespace {

constexpr uint8_t kKey[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
constexpr uint8_t kRobot = 1;
constexpr uint16_t kBootEpoch = 17;
constexpr uint16_t kCounter = 0x0142;  // of the next command that the robot would take

/// The MAC that the robot expects: over what the frame says, its own epoch and counter.
void expected_mac(const CanFrame& frame, uint8_t (&mac)[kSipHashSize]) {
  command_mac(kKey, frame.id, kRobot, kBootEpoch,
              static_cast<uint16_t>((kCounter & 0xFF00U) | frame.data[kCommandFreshnessOffset]),
              frame.data, mac);
}

}  // namespace

CanFrame RandomFrames::next() {
  return fill(messages()[random_.next() % messages().size()]);
}

CanFrame RandomFrames::next(bool uplink) {
  for (;;) {
    const MessageInfo& message = messages()[random_.next() % messages().size()];
    if (message.uplink == uplink) return fill(message);
  }
}

CanFrame RandomFrames::fill(const MessageInfo& message) {
  CanFrame frame{};
  frame.id = id_of_node(message.id, static_cast<uint8_t>(1 + random_.next() % 3));
  frame.size = message.size;
  for (uint8_t i = 0; i < frame.size; ++i) {
    const uint32_t draw = random_.next();
    constexpr uint8_t kEdges[] = {0x00, 0xFF, 0x7F, 0x80};
    frame.data[i] = (draw & 0x100U) != 0 ? static_cast<uint8_t>(draw) : kEdges[draw & 3U];
  }
  if (message.protected_by_crc) {
    uint8_t& counter = counters_[frame.id];
    e2e_protect(frame.id, counter, frame.data, frame.size);
    counter = (counter + 1U) & 0x0FU;
  } else {
    uint8_t mac[kSipHashSize];
    expected_mac(frame, mac);
    std::memcpy(frame.data + kCommandMacOffset, mac, kCommandMacSize);
  }
  return frame;
}

bool RandomFrames::accepts(const CanFrame& frame, bool uplink) {
  if (check_received(frame, uplink) != FrameFault::kNone) return false;
  if (find_message(frame.id)->protected_by_crc) return true;
  uint8_t mac[kSipHashSize];
  expected_mac(frame, mac);
  return std::memcmp(frame.data + kCommandMacOffset, mac, kCommandMacSize) == 0;
}

namespace {

using Bytes = std::vector<uint8_t>;

/// Two lines, one after the other; the first one ends before `first_size`.
struct TwoLines {
  Bytes bytes;
  size_t first_size;
};

class Damage {
 public:
  explicit Damage(WorldRandom& random) : random_(random) {}

  void wrong_bits(TwoLines& it, int count) {
    // Different bits, anywhere in the first line.
    std::vector<size_t> bits;
    while (bits.size() < static_cast<size_t>(count)) {
      const size_t bit = below(it.first_size * 8);
      if (std::find(bits.begin(), bits.end(), bit) != bits.end()) continue;
      bits.push_back(bit);
      it.bytes[bit / 8] = static_cast<uint8_t>(it.bytes[bit / 8] ^ (1U << (bit % 8)));
    }
  }
  void wrong_byte(TwoLines& it) {
    uint8_t& byte = it.bytes[below(it.first_size)];
    byte = static_cast<uint8_t>(byte ^ (1U + below(255)));
  }
  void wrong_bytes_in_a_row(TwoLines& it) {
    const size_t begin = below(it.first_size);
    const size_t end = std::min(it.first_size, begin + 2 + below(7));
    for (size_t i = begin; i < end; ++i) it.bytes[i] = static_cast<uint8_t>(random_.next());
  }
  /// A hexadecimal digit in place of another, twice: the worst for a check of characters.
  void two_wrong_digits(TwoLines& it) {
    constexpr char kDigits[] = "0123456789ABCDEF";
    for (int i = 0; i < 2; ++i) {
      it.bytes[1 + below(it.first_size - 2)] = static_cast<uint8_t>(kDigits[below(16)]);
    }
  }
  void lost_byte(TwoLines& it) { it.bytes.erase(at(it, below(it.first_size))); }
  void doubled_byte(TwoLines& it) {
    const auto place = at(it, below(it.first_size));
    const uint8_t byte = *place;
    it.bytes.insert(place, byte);
  }
  void lost_and_doubled_byte(TwoLines& it) {
    doubled_byte(it);
    it.bytes.erase(at(it, below(it.first_size + 1)));
  }
  /// The line's middle or end is missing; its end of line stays.
  void cut_inside(TwoLines& it) {
    const size_t begin = below(it.first_size - 1);
    const size_t end = begin + 1 + below(it.first_size - 1 - begin);
    it.bytes.erase(at(it, begin), at(it, end));
  }
  /// Everything from a place in the first line to a place in the second one is missing: what stays
  /// of both makes one line.
  void merged(TwoLines& it) {
    const size_t begin = below(it.first_size);
    const size_t end = it.first_size + below(it.bytes.size() - it.first_size);
    it.bytes.erase(at(it, begin), at(it, end));
  }
  /// As merged(), with the length of a whole line: the second one goes on where the first broke
  /// off.
  void merged_to_a_whole_line(TwoLines& it) {
    const size_t begin = 1 + below(it.first_size - 1);
    it.bytes.erase(at(it, begin), at(it, std::min(it.first_size + begin, it.bytes.size())));
  }

 private:
  static Bytes::iterator at(TwoLines& it, size_t place) {
    return it.bytes.begin() + static_cast<std::ptrdiff_t>(place);
  }
  size_t below(size_t limit) {
    return static_cast<size_t>(static_cast<uint64_t>(random_.next()) * limit >> 32U);
  }

  WorldRandom& random_;
};

struct DamageMode {
  const char* name;
  void (*damage)(Damage&, TwoLines&);
};

constexpr DamageMode kDamageModes[] = {
    {"one wrong bit", [](Damage& d, TwoLines& it) { d.wrong_bits(it, 1); }},
    {"two wrong bits", [](Damage& d, TwoLines& it) { d.wrong_bits(it, 2); }},
    {"three wrong bits", [](Damage& d, TwoLines& it) { d.wrong_bits(it, 3); }},
    {"one wrong byte", [](Damage& d, TwoLines& it) { d.wrong_byte(it); }},
    {"one lost byte", [](Damage& d, TwoLines& it) { d.lost_byte(it); }},
    {"one doubled byte", [](Damage& d, TwoLines& it) { d.doubled_byte(it); }},
    {"one lost and one doubled byte", [](Damage& d, TwoLines& it) { d.lost_and_doubled_byte(it); }},
    {"two random digits", [](Damage& d, TwoLines& it) { d.two_wrong_digits(it); }},
    {"2 to 8 random bytes in a row", [](Damage& d, TwoLines& it) { d.wrong_bytes_in_a_row(it); }},
    {"a piece cut out", [](Damage& d, TwoLines& it) { d.cut_inside(it); }},
    {"two lines merged", [](Damage& d, TwoLines& it) { d.merged(it); }},
    {"two lines merged to a whole length",
     [](Damage& d, TwoLines& it) { d.merged_to_a_whole_line(it); }},
};

bool same(const CanFrame& a, const CanFrame& b) {
  return a.id == b.id && a.size == b.size && std::memcmp(a.data, b.data, a.size) == 0;
}

}  // namespace

std::vector<CorruptionResult> damage_lines(uint64_t lines, uint64_t seed) {
  std::vector<CorruptionResult> results;
  for (const DamageMode& mode : kDamageModes) {
    WorldRandom random(seed, mode.name);
    Damage damage(random);
    RandomFrames frames(random.next());
    CorruptionResult result;
    result.damage = mode.name;
    TwoLines text;
    for (; result.lines < lines; ++result.lines) {
      const bool uplink = (result.lines & 1U) != 0;
      const CanFrame sent[2] = {frames.next(uplink), frames.next(uplink)};
      uint8_t line[kSlcanLineMax];
      text.first_size = slcan_encode(sent[0], line);
      text.bytes.assign(line, line + text.first_size);
      text.bytes.insert(text.bytes.end(), line, line + slcan_encode(sent[1], line));
      mode.damage(damage, text);
      text.bytes.push_back('\r');  // whatever was begun ends here
      SlcanParser parser;
      CanFrame got{};
      for (const uint8_t byte : text.bytes) {
        if (!parser.feed(byte, got) || same(got, sent[0]) || same(got, sent[1])) continue;
        ++result.wrong_lines;
        if (RandomFrames::accepts(got, uplink)) ++result.wrong_frames;
      }
    }
    results.push_back(result);
  }
  return results;
}

}  // namespace screed
