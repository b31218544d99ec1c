// Where the image of a board is looked for.
#include "host_sim/core/data_folders.h"
#include "host_sim/run/world/image_robot.h"

namespace screed {

std::string default_image(const std::string& board) {
  return (data_folders().firmware / board / "screed.elf").string();
}

}  // namespace screed
