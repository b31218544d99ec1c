// A simulated robot's radio, offered to other programs of this machine: as the serial port of an
// XBee, or as frames on a CAN interface.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host_sim/ground_station/link/can_link.h"
#include "host_sim/ground_station/link/pseudo_terminal.h"
#include "host_sim/ground_station/station/ground_station.h"

namespace screed {

/// The serial port of an XBee in transparent mode.
class TerminalPort : public GroundPort {
 public:
  /// Throws as PseudoTerminal does.
  explicit TerminalPort(const std::optional<std::filesystem::path>& link) : terminal_(link) {}

  void send(std::span<const uint8_t> bytes) override { terminal_.write(bytes); }
  std::vector<uint8_t> receive() override { return terminal_.read(); }
  const std::filesystem::path& device() const { return terminal_.device(); }

 private:
  PseudoTerminal terminal_;
};

/// A CAN interface, as slcand makes one of the XBee.
class CanPort : public GroundPort {
 public:
  /// Throws as CanLink does.
  explicit CanPort(const std::string& interface) : link_(interface) {}

  void send(std::span<const uint8_t> bytes) override;
  std::vector<uint8_t> receive() override;

 private:
  CanLink link_;
  SlcanParser parser_;
  std::vector<LinkFrame> frames_;
};

/// Several ports at once.
class PortGroup : public GroundPort {
 public:
  void add(std::unique_ptr<GroundPort> port) { ports_.push_back(std::move(port)); }
  bool empty() const { return ports_.empty(); }

  void send(std::span<const uint8_t> bytes) override;
  std::vector<uint8_t> receive() override;

 private:
  std::vector<std::unique_ptr<GroundPort>> ports_;
};

}  // namespace screed
