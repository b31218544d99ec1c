// [radio] of an experiment file: the link between robot and ground station, and its key.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/ground_station/station/command_key.h"

namespace screed {

inline constexpr const char* kNoCommandKey = "none";  ///< [radio] key of a robot without one

struct RadioSection {
  double delay_s = 0.012;
  double loss = 0.0;
  double bit_errors = 0.0;
  double duplication = 0.0;
  std::optional<double> range_m;
  double baud = 58823.5;
  double packet_pause = 3.0;
  bool ground_station = true;
  std::string key;  ///< empty: the test key
  uint16_t boot_epoch = kFirstBootEpoch;

  template <class Keys>
  static void list(Keys& keys) {
    using R = RadioSection;
    keys.real("delay", "s", 0, 10,
              "latency of a packet, from its end in one module to its first byte out of the other",
              &R::delay_s);
    keys.real("loss", "", 0, 1, "probability that a packet is lost", &R::loss);
    keys.real("bit_errors", "", 0, 1, "probability that a bit of an arriving byte is wrong",
              &R::bit_errors);
    keys.real("duplication", "", 0, 1, "probability that an arriving packet comes twice",
              &R::duplication);
    keys.real("range", "m", 0.1, 100000,
              "distance at which half of the full packets are lost; left out: none is too far",
              &R::range_m);
    keys.real("baud", "baud", 1200, 1e6,
              "baud rate of the serial lines at the modules, 10 bits a byte", &R::baud);
    keys.real("packet_pause", "characters", 1, 255,
              "silence that ends a packet (the XBee's parameter RO)", &R::packet_pause);
    keys.flag("ground_station", "the ground station arms and starts the robot", &R::ground_station);
    keys.text("key",
              "32 hexadecimal digits, then a blank and the robot's id if it is not 1; or none",
              "command key of robot and ground station; left out: the test key 00 01 .. 0F; none: "
              "the robot has no key",
              &R::key, [](const std::string& text) {
                if (text == kNoCommandKey) return true;
                try {
                  parse_key(text, "");
                  return true;
                } catch (const InputError&) {
                  return false;
                }
              });
    keys.integer("boot_epoch", "", kFirstBootEpoch, UINT16_MAX,
                 "number of the robot's start, part of every command's freshness", &R::boot_epoch);
  }
};

}  // namespace screed
