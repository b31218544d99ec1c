// Frames between programs: a packet each, on a socket that keeps packets apart.
#include "host_sim/ground_station/link/shared_link.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <system_error>
#include <utility>

#include "firmware/protocol/messages.h"
#include "host_sim/core/errors.h"
#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {
namespace {

constexpr uint32_t kVersion = 1;  ///< of Packet
constexpr std::chrono::milliseconds kSlice{10};
constexpr std::chrono::milliseconds kLookAgain{500};
// A robot takes a ground station for lost after as long.
constexpr uint64_t kHeartbeatLost_us = 500'000;
// An answer takes a tenth of that by cable or a good radio.
constexpr uint64_t kAnswerLost_us = 300'000;
constexpr int kOwner = -1;
constexpr int kMaxGuests = 16;
constexpr int kMaxTries = 100;

/// What travels in either direction, between two programs of one machine. A guest sends frames
/// alone.
struct Packet {
  uint32_t version = kVersion;
  bool is_status = false;
  bool up = false;
  bool has_source = false;
  bool has_rssi = false;
  int32_t rssi_dbm = 0;
  uint64_t time_us = 0;
  uint64_t address = 0;
  uint64_t received = 0;  ///< by the owner's link
  CanFrame frame{};
  std::array<char, 96> text{};  ///< of the status, with its 0
};

Packet packet_of(const LinkFrame& from) {
  Packet packet;
  packet.time_us = from.time_us;
  packet.frame = from.frame;
  if (from.source.has_value()) {
    packet.has_source = true;
    packet.address = from.source->address;
    packet.has_rssi = from.source->rssi_dbm.has_value();
    packet.rssi_dbm = from.source->rssi_dbm.value_or(0);
  }
  return packet;
}

Packet packet_of(const LinkStatus& status) {
  Packet packet;
  packet.is_status = true;
  packet.up = status.up;
  packet.received = status.received;
  packet.has_rssi = status.rssi_dbm.has_value();
  packet.rssi_dbm = status.rssi_dbm.value_or(0);
  std::strncpy(packet.text.data(), status.text.c_str(), packet.text.size() - 1);
  return packet;
}

LinkFrame frame_of(const Packet& packet) {
  LinkFrame frame;
  frame.time_us = packet.time_us;
  frame.frame = packet.frame;
  if (packet.has_source) {
    frame.source = RadioSource{packet.address, std::nullopt};
    if (packet.has_rssi) frame.source->rssi_dbm = packet.rssi_dbm;
  }
  return frame;
}

/// In the abstract name space: a 0 in front, no file anywhere.
std::pair<sockaddr_un, socklen_t> socket_address(const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const size_t size = std::min(name.size(), sizeof address.sun_path - 1);
  std::memcpy(address.sun_path + 1, name.data(), size);
  return {address, static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + size)};
}

FileDescriptor new_socket() {
  FileDescriptor made(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!made.is_open())
    throw RunError(std::string("a local socket cannot be made: ") + std::strerror(errno));
  return made;
}

/// Programs of other users may not drive this one's robot.
bool is_this_user(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  return getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 && peer.uid == geteuid();
}

/// False: it has gone. A peer that is too slow loses the packet.
bool put(int socket, const Packet& packet) {
  return ::send(socket, &packet, sizeof packet, MSG_NOSIGNAL) >= 0 || errno == EAGAIN ||
         errno == EWOULDBLOCK || errno == ENOBUFS;
}

enum class Got { kPacket, kNothing, kEnd };
Got get(int socket, Packet& packet) {
  const ssize_t size = recv(socket, &packet, sizeof packet, 0);
  if (size == static_cast<ssize_t>(sizeof packet) && packet.version == kVersion)
    return Got::kPacket;
  if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return Got::kNothing;
  return Got::kEnd;
}

bool is_heartbeat(const CanFrame& frame) {
  return frame.id == kIdGroundHeartbeat;
}

/// Of whichever robot.
bool is_message(const CanFrame& frame, uint16_t id_of_node_1) {
  return find_message(frame.id) == find_message(id_of_node_1);
}

}  // namespace

SharedLink::SharedLink(const std::filesystem::path& device, Open open)
    : name_(device.string()), open_(std::move(open)) {
  std::error_code error;
  const std::filesystem::path same = std::filesystem::canonical(device, error);
  address_ = "screed " + std::to_string(geteuid()) + " " + (error ? name_ : same.string());
  // Neither succeeds only while an owner begins or ends.
  for (int tries = 0; !join() && !own(); ++tries) {
    if (tries == kMaxTries)
      throw RunError(name_ + ": another program holds the socket that shares the port");
    wait_readable(-1, kSlice);
  }
}

SharedLink::~SharedLink() = default;

bool SharedLink::join() {
  FileDescriptor socket = new_socket();
  const auto [address, size] = socket_address(address_);
  if (connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      !is_this_user(socket.get()))
    return false;
  // The owner says how its link is as soon as it has a moment.
  Packet packet;
  if (wait_readable(socket.get(), std::chrono::seconds(2)) == Readiness::kNothing)
    throw RunError(name_ + ": another screed holds the port and does not answer");
  const ssize_t got = recv(socket.get(), &packet, sizeof packet, 0);
  if (got <= 0) return false;  // it has ended
  if (got != static_cast<ssize_t>(sizeof packet) || packet.version != kVersion)
    throw RunError(name_ + ": a screed of another version holds the port");
  owner_ = std::move(socket);
  status_ = {};
  status_.up = packet.up;
  status_.text = packet.text.data();
  return true;
}

bool SharedLink::own() {
  FileDescriptor socket = new_socket();
  const auto [address, size] = socket_address(address_);
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0) return false;
  // Others may come while the port is opened: they wait for a word, or for the end.
  if (listen(socket.get(), kMaxGuests) != 0)
    throw RunError(name_ + ": cannot be shared: " + std::strerror(errno));
  own_ = open_();
  listener_ = std::move(socket);
  owner_.reset();
  return true;
}

void SharedLink::receive(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) {
  if (!own_) return receive_as_guest(wait, frames);
  const auto end = std::chrono::steady_clock::now() + wait;
  const size_t first = frames.size();
  for (;;) {
    const size_t before = frames.size();
    own_->receive(std::min(wait, kSlice), frames);
    serve(frames, before);
    if (frames.size() > first || std::chrono::steady_clock::now() >= end) return;
  }
}

void SharedLink::serve(const std::vector<LinkFrame>& frames, size_t first) {
  FileDescriptor guest(accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (guest.is_open() && is_this_user(guest.get()) && put(guest.get(), packet_of(own_->status())))
    guests_.push_back({std::move(guest), 0});
  for (size_t i = first; i < frames.size(); ++i)
    if (is_message(frames[i].frame, kIdCommandAck)) command_us_ = 0;
  const bool news = told_ != own_->status().text;
  if (news) told_ = own_->status().text;
  std::erase_if(guests_, [&](Guest& it) {
    if (news && !put(it.socket.get(), packet_of(own_->status()))) return true;
    for (size_t i = first; i < frames.size(); ++i)
      if (!put(it.socket.get(), packet_of(frames[i]))) return true;
    return !take_from(it);
  });
}

bool SharedLink::may_pass(const CanFrame& frame, int from) {
  if (!is_message(frame, kIdCommand)) return true;
  const uint64_t now_us = wall_clock_us();
  if (now_us < command_us_ + kAnswerLost_us && commander_ != from) return false;
  commander_ = from;
  command_us_ = now_us;
  return true;
}

bool SharedLink::take_from(Guest& guest) {
  Packet packet;
  for (;;) {
    const Got got = get(guest.socket.get(), packet);
    if (got != Got::kPacket) return got == Got::kNothing;
    if (is_heartbeat(packet.frame)) {
      const uint64_t now_us = wall_clock_us();
      const auto lives = [now_us](uint64_t heartbeat_us) {
        return now_us < heartbeat_us + kHeartbeatLost_us;
      };
      const bool other = std::any_of(guests_.begin(), guests_.end(), [&](const Guest& it) {
        return &it != &guest && lives(it.heartbeat_us);
      });
      if (other || lives(heartbeat_us_)) continue;
      guest.heartbeat_us = now_us;
    }
    if (may_pass(packet.frame, guest.socket.get())) own_->send(packet.frame);
  }
}

void SharedLink::receive_as_guest(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) {
  if (!owner_.is_open()) {
    wait_readable(-1, std::min(wait, kLookAgain));
    const auto now = std::chrono::steady_clock::now();
    if (now < looked_at_ + kLookAgain) return;
    looked_at_ = now;
    try {
      if (join() || own()) ++status_.interruptions;
    } catch (const std::exception& error) {
      status_.text = error.what();
    }
    return;
  }
  if (wait_readable(owner_.get(), wait) == Readiness::kNothing) return;
  Packet packet;
  for (;;) {
    const Got got = get(owner_.get(), packet);
    if (got == Got::kNothing) return;
    if (got == Got::kEnd) {
      owner_.reset();
      status_.up = false;
      status_.text = "the program that held the port has ended";
      looked_at_ = {};
      return;
    }
    if (packet.is_status) {
      status_.up = packet.up;
      status_.text = packet.text.data();
      continue;
    }
    frames.push_back(frame_of(packet));
    ++status_.received;
    if (packet.has_rssi) status_.rssi_dbm = packet.rssi_dbm;
  }
}

bool SharedLink::send(const CanFrame& frame) {
  if (own_) {
    if (is_heartbeat(frame)) heartbeat_us_ = wall_clock_us();
    return may_pass(frame, kOwner) ? own_->send(frame) : true;
  }
  Packet packet;
  packet.frame = frame;
  const bool sent = owner_.is_open() && put(owner_.get(), packet);
  ++(sent ? status_.sent : status_.not_sent);
  return sent;
}

}  // namespace screed
