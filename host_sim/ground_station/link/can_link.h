// CAN frames over a Linux CAN interface (SocketCAN): a real adapter, a radio behind slcand, or
// vcan.
//
// Only data frames with 11-bit ids are let through (a filter in the kernel); error frames are read
// as well and reported in status(). Times are the kernel's.
#pragma once

#include <chrono>
#include <string>

#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/link/pseudo_terminal.h"

struct can_frame;  // <linux/can.h>

namespace screed {

class CanLink : public Link {
 public:
  /// Throws RunError when the kernel has no CAN or refuses, InputError when there is no interface
  /// of this name or it is no CAN interface. One that is down is no error.
  explicit CanLink(const std::string& interface);

  void receive(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) override;
  bool send(const CanFrame& frame) override;
  const LinkStatus& status() const override { return status_; }
  const std::string& name() const override { return interface_; }

 private:
  bool bind_socket();
  void look_at_interface();
  void read_frames(std::vector<LinkFrame>& frames);
  void take_error(const can_frame& frame);
  void mark_down(const std::string& why);
  void set_up();

  std::string interface_;
  FileDescriptor socket_;
  LinkStatus status_;
  bool bus_off_ = false;
  unsigned index_ = 0;  ///< of the interface the socket is bound to; 0: none
  uint32_t kernel_dropped_ = 0;
  std::chrono::steady_clock::time_point looked_at_;
};

}  // namespace screed
