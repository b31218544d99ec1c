// Time as the flashing tools see it: handed in, so that a test waits for nothing.
#pragma once

#include <chrono>
#include <functional>

namespace screed::flash {

struct Clock {
  std::function<std::chrono::milliseconds()> now;
  std::function<void(std::chrono::milliseconds)> pause;
};

/// The machine's own clock.
Clock machine_clock();

}  // namespace screed::flash
