// Waiting for a file descriptor.
#include "host_sim/ground_station/link/file_descriptor.h"

#include <poll.h>

namespace screed {

Readiness wait_readable(int descriptor, std::chrono::milliseconds wait) {
  pollfd entry{descriptor, POLLIN, 0};
  const int ready = poll(&entry, 1, static_cast<int>(wait.count()));
  if (ready <= 0) return Readiness::kNothing;  // also a signal: the caller comes back
  if ((entry.revents & POLLIN) != 0) return Readiness::kReadable;
  return Readiness::kBroken;
}

}  // namespace screed
