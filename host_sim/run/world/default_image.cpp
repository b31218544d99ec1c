// Where the image of a board is looked for.
#include "host_sim/run/world/co_simulation.h"
#include "paths.h"

namespace screed {

std::string default_image(const std::string& board) {
  return std::string(kFirmwareFolder) + "/" + board + "/screed.elf";
}

}  // namespace screed
