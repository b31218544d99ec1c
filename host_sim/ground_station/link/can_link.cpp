// SocketCAN.
#include "host_sim/ground_station/link/can_link.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <thread>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr std::chrono::milliseconds kCanLookAgain{250};
/// What a burst may pile up while this program draws its screen.
constexpr int kReceiveBuffer = 1 << 20;

enum class InterfaceState { kMissing, kDown, kUp, kNoCan };

InterfaceState state_of(const std::string& interface, int socket) {
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  if (ioctl(socket, SIOCGIFHWADDR, &request) != 0) return InterfaceState::kMissing;
  if (request.ifr_hwaddr.sa_family != ARPHRD_CAN) return InterfaceState::kNoCan;
  if (ioctl(socket, SIOCGIFFLAGS, &request) != 0) return InterfaceState::kMissing;
  return (request.ifr_flags & IFF_UP) != 0 ? InterfaceState::kUp : InterfaceState::kDown;
}

/// The problems an error frame tells, in words.
std::string words_of(const can_frame& frame) {
  struct Word {
    canid_t bit;
    const char* text;
  };
  constexpr Word kWords[] = {
      {CAN_ERR_TX_TIMEOUT, "transmission timed out"},
      {CAN_ERR_LOSTARB, "arbitration lost"},
      {CAN_ERR_CRTL, "controller warns"},
      {CAN_ERR_PROT, "protocol violated"},
      {CAN_ERR_TRX, "transceiver fault"},
      {CAN_ERR_ACK, "no node acknowledges"},
      {CAN_ERR_BUSERROR, "bus error"},
  };
  std::string text;
  for (const Word& word : kWords) {
    if ((frame.can_id & word.bit) != 0) text += (text.empty() ? "" : ", ") + std::string(word.text);
  }
  return text.empty() ? "error on the bus" : text;
}

}  // namespace

CanLink::CanLink(const std::string& interface) : interface_(interface) {
  if (interface.empty() || interface.size() >= IFNAMSIZ)
    throw InputError("CAN interface '" + interface + "': a name has 1 to 15 characters");
  socket_ = FileDescriptor(socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW));
  if (!socket_.is_open()) {
    if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
      throw RunError(interface +
                     ": this machine's kernel has no CAN (modprobe can_raw, or use --pty; "
                     "docs/link.md)");
    }
    throw RunError(interface + ": no CAN socket: " + std::strerror(errno));
  }
  const int on = 1;
  setsockopt(socket_.get(), SOL_SOCKET, SO_TIMESTAMP, &on, sizeof on);
  setsockopt(socket_.get(), SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);

  switch (state_of(interface_, socket_.get())) {
    case InterfaceState::kMissing:
      throw InputError(interface + ": no such interface (ip link add dev " + interface +
                       " type vcan, or slcand; docs/link.md)");
    case InterfaceState::kNoCan:
      throw InputError(interface + ": not a CAN interface");
    default:
      break;
  }
  if (!bind_socket()) throw RunError(interface + ": " + std::strerror(errno));
  look_at_interface();
  status_.interruptions = 0;
}

bool CanLink::bind_socket() {
  sockaddr_can address{};
  address.can_family = AF_CAN;
  index_ = if_nametoindex(interface_.c_str());
  address.can_ifindex = static_cast<int>(index_);
  if (index_ == 0) return false;
  // Set at every binding: the kernel forgets them with an interface that is taken away.
  // 11-bit data frames, and every kind of error frame.
  const can_filter filter = {0, CAN_EFF_FLAG | CAN_RTR_FLAG};
  const can_err_mask_t errors = CAN_ERR_MASK;
  setsockopt(socket_.get(), SOL_CAN_RAW, CAN_RAW_FILTER, &filter, sizeof filter);
  setsockopt(socket_.get(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors);
  return bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

void CanLink::mark_down(const std::string& why) {
  if (status_.up) ++status_.interruptions;
  status_.up = false;
  status_.text = why;
}

void CanLink::set_up() {
  status_.up = true;
  status_.text = "up";
}

/// The kernel tells once that an interface went down and never that it is back.
void CanLink::look_at_interface() {
  looked_at_ = std::chrono::steady_clock::now();
  switch (state_of(interface_, socket_.get())) {
    case InterfaceState::kMissing:
    case InterfaceState::kNoCan:
      index_ = 0;
      bus_off_ = false;  // a controller that was stopped starts anew
      return mark_down("the interface is gone; waiting for it to come back");
    case InterfaceState::kDown:
      bus_off_ = false;
      return mark_down("the interface is down (ip link set " + interface_ + " up)");
    case InterfaceState::kUp:
      break;
  }
  // An interface that was taken away and made anew is another one to the socket.
  if (index_ != if_nametoindex(interface_.c_str()) && !bind_socket())
    return mark_down(std::string("cannot be bound: ") + std::strerror(errno));
  if (!bus_off_ && !status_.up) set_up();
}

void CanLink::receive(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) {
  if (std::chrono::steady_clock::now() - looked_at_ >= kCanLookAgain) look_at_interface();
  if (index_ == 0) {
    std::this_thread::sleep_for(std::min(wait, kCanLookAgain));
    return;
  }
  if (wait_readable(socket_.get(), wait) != Readiness::kNothing) read_frames(frames);
}

void CanLink::read_frames(std::vector<LinkFrame>& frames) {
  for (;;) {
    can_frame raw{};
    iovec part{&raw, sizeof raw};
    alignas(cmsghdr) std::array<char, 256> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = recvmsg(socket_.get(), &message, 0);
    if (size < 0) {
      if (errno == ENETDOWN || errno == ENODEV || errno == ENXIO) look_at_interface();
      return;  // EAGAIN: nothing more
    }
    if (size != sizeof raw) continue;

    LinkFrame frame;
    frame.time_us = wall_clock_us();
    for (cmsghdr* part_of = CMSG_FIRSTHDR(&message); part_of != nullptr;
         part_of = CMSG_NXTHDR(&message, part_of)) {
      if (part_of->cmsg_level != SOL_SOCKET) continue;
      if (part_of->cmsg_type == SO_TIMESTAMP) {
        timeval time{};
        std::memcpy(&time, CMSG_DATA(part_of), sizeof time);
        frame.time_us =
            static_cast<uint64_t>(time.tv_sec) * 1000000U + static_cast<uint64_t>(time.tv_usec);
      } else if (part_of->cmsg_type == SO_RXQ_OVFL) {
        uint32_t dropped = 0;
        std::memcpy(&dropped, CMSG_DATA(part_of), sizeof dropped);
        status_.dropped += dropped - kernel_dropped_;
        kernel_dropped_ = dropped;
      }
    }
    if ((raw.can_id & CAN_ERR_FLAG) != 0) {
      take_error(raw);
      continue;
    }
    frame.frame.id = static_cast<uint16_t>(raw.can_id & CAN_SFF_MASK);
    frame.frame.size = std::min<uint8_t>(raw.can_dlc, 8);
    std::copy_n(raw.data, frame.frame.size, frame.frame.data);
    frames.push_back(frame);
    ++status_.received;
  }
}

void CanLink::take_error(const can_frame& frame) {
  ++status_.errors;
  if ((frame.can_id & CAN_ERR_BUSOFF) != 0) {
    bus_off_ = true;
    mark_down("bus off: too many errors; the interface restarts by itself when restart-ms is set");
  } else if ((frame.can_id & CAN_ERR_RESTARTED) != 0) {
    bus_off_ = false;
    set_up();
  } else if (status_.up) {
    status_.text = "up; " + words_of(frame);
  }
}

bool CanLink::send(const CanFrame& frame) {
  can_frame raw{};
  raw.can_id = frame.id;
  raw.can_dlc = frame.size;
  std::copy_n(frame.data, frame.size, raw.data);
  // A full queue (slcan's holds ten lines) empties at the speed of the line behind it.
  for (int attempt = 0; attempt < 50; ++attempt) {
    if (write(socket_.get(), &raw, sizeof raw) == sizeof raw) {
      ++status_.sent;
      return true;
    }
    if (errno != ENOBUFS && errno != EAGAIN && errno != EINTR) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (errno == ENETDOWN || errno == ENODEV || errno == ENXIO) look_at_interface();
  ++status_.not_sent;
  return false;
}

}  // namespace screed
