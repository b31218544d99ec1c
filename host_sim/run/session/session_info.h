// What a session says about its run as a whole.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"
#include "hal/sample.h"
#include "host_sim/ground_station/station/command_key.h"
#include "host_sim/physics/terrain/height_map.h"

namespace screed {

struct SessionInfo {
  std::string program_version;  ///< not part of the content hash
  std::string arithmetic;       ///< of the world (arithmetic.h); not part of it either
  std::string experiment_name;  ///< not part of the content hash
  /// the whole INI text that was in force, overrides applied; any size, no NUL byte
  std::string experiment_text;
  std::uint64_t seed = 0;
  std::uint32_t tick_rate_hz = kTickRate_hz;
  std::string board_name;
  BoardConstants board{};
  Parameters parameters;
  Credentials credentials = credentials_of(test_key());
};

}  // namespace screed
