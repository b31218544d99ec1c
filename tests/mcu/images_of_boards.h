// The images of all boards; the build makes each of them (hal/avr/firmware.mk).
#pragma once

#include <filesystem>
#include <string>

#include "host_sim/devices/mcu/wiring.h"
#include "paths.h"
#include "tests/mcu/images.h"

namespace screed::mcu {

inline std::string image_of(const std::string& board) {
  return (std::filesystem::path(kScreedImage).parent_path().parent_path() / board / "screed.elf")
      .string();
}

inline Wiring wiring_of(const std::string& board) {
  return read_wiring(std::filesystem::path(kBoardsFolder) / board / "wiring.ini");
}

}  // namespace screed::mcu
