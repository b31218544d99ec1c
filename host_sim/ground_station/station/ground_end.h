// The ground end of the radio: the simulated ground station, and programs outside that listen and
// speak beside it.
//
// A program that sends heartbeats is a ground station; from its first one the simulated station is
// silent for good, since two stations would hide each other's loss from the robot.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/protocol/slcan.h"
#include "host_sim/devices/radio/radio_link.h"
#include "host_sim/ground_station/station/ground_port.h"
#include "host_sim/ground_station/station/ground_station.h"

namespace screed {

class GroundEnd {
 public:
  /// `port` may be null; it must outlive this.
  explicit GroundEnd(GroundPort* port) : port_(port) {}

  /// One control tick: what is to be said goes into the uplink, what has come down is taken out.
  void tick(uint64_t now_us, GroundStation& station, RadioLink& uplink, RadioLink& downlink);

  /// A program outside has taken over.
  bool handed_over() const { return handed_over_; }

 private:
  void listen(std::span<const uint8_t> bytes);

  GroundPort* port_;
  SlcanParser outside_;
  bool handed_over_ = false;
};

}  // namespace screed
