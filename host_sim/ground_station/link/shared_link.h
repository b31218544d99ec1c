// A serial port that several programs of a user share: the first one owns it, the others reach it
// over a local socket that the owner serves, and when the owner ends one of them takes its place.
//
// Everybody hears every frame. Everybody may send, but one program alone is the robot's ground
// station, the owner if it sends heartbeats, else the first that does: heartbeats of the others are
// dropped, since their counters would contradict one another. Likewise a COMMAND is dropped while
// somebody else's waits for its answer: CommandSession hears that answer and signs it anew.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/link/pseudo_terminal.h"

namespace screed {

class SharedLink : public Link {
 public:
  using Open = std::function<std::unique_ptr<Link>()>;

  /// Joins the program that owns the port, or opens it. Throws what `open` throws; RunError when
  /// the owner is a program of another version.
  SharedLink(const std::filesystem::path& device, Open open);
  ~SharedLink() override;

  void receive(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) override;
  bool send(const CanFrame& frame) override;
  const LinkStatus& status() const override { return own_ ? own_->status() : status_; }
  const std::string& name() const override { return name_; }

  /// Whether this program holds the port itself.
  bool owns() const { return own_ != nullptr; }

 private:
  struct Guest {
    FileDescriptor socket;
    uint64_t heartbeat_us = 0;  ///< when it sent one
  };

  /// False: somebody owns the port, and has ended meanwhile.
  bool join();
  /// False: somebody else owns it by now.
  bool own();
  void serve(const std::vector<LinkFrame>& frames, size_t first);
  /// False: the guest has gone.
  bool take_from(Guest& guest);
  /// From the owner, or the guest of this socket: it may go out now.
  bool may_pass(const CanFrame& frame, int from);
  void receive_as_guest(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames);

  std::string name_;
  std::string address_;  ///< of the socket, in Linux' abstract name space: it goes with its owner
  Open open_;

  // Of the owner.
  std::unique_ptr<Link> own_;
  FileDescriptor listener_;
  std::vector<Guest> guests_;
  uint64_t heartbeat_us_ = 0;  ///< when this program sent one
  int commander_ = 0;          ///< whose COMMAND waits for its answer: as `from`
  uint64_t command_us_ = 0;    ///< since when; 0: none does
  std::string told_;           ///< text of the status that guests know

  // Of a guest.
  FileDescriptor owner_;
  LinkStatus status_;
  std::chrono::steady_clock::time_point looked_at_;
};

}  // namespace screed
