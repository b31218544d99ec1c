// The ground end of the radio for programs outside of the simulation: bytes as the radio module
// gives them out and takes them in.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace screed {

class GroundPort {
 public:
  GroundPort() = default;
  GroundPort(const GroundPort&) = delete;
  GroundPort& operator=(const GroundPort&) = delete;
  virtual ~GroundPort() = default;

  /// What has come down in this tick. Never waits.
  virtual void send(std::span<const uint8_t> bytes) = 0;
  /// What is to go up. Never waits.
  virtual std::vector<uint8_t> receive() = 0;
};

}  // namespace screed
