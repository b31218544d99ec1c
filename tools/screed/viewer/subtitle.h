// The line below the title: who drives, on which terrain.
#pragma once

#include <cstdint>
#include <string>

namespace screed::viewer {

/// Who moves the robot.
struct Driver {
  enum class Kind : uint8_t {
    kAlgorithm,         ///< the firmware
    kKeyboard,          ///< the user of this viewer
    kGamepad,           ///< likewise
    kSimulatedStation,  ///< the run's own ground station, as the experiment file says
    kExternalStation,   ///< another program, over the radio
    kUnknownStation     ///< a ground station: a recording does not say which
  };

  Kind kind = Kind::kAlgorithm;
  std::string algorithm;       ///< its name, for kAlgorithm
  bool external_link = false;  ///< kAlgorithm, supervised by another program's heartbeats
  bool replay = false;         ///< of a recorded run

  bool operator==(const Driver&) const = default;
};

/// The terrain as a user calls it: "soft soil (dry_sand)". model: of the section [map].
std::string terrain_name(const std::string& model, const std::string& soil);

/// "hill_sensing drives on rigid ground, seed 1".
std::string subtitle_of(const Driver& driver, const std::string& terrain, uint64_t seed);

}  // namespace screed::viewer
