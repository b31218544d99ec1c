#include "tools/flash/clock.h"

#include <thread>

namespace screed::flash {

Clock machine_clock() {
  using std::chrono::milliseconds;
  return {[] {
            const auto now = std::chrono::steady_clock::now().time_since_epoch();
            return std::chrono::duration_cast<milliseconds>(now);
          },
          [](milliseconds duration) { std::this_thread::sleep_for(duration); }};
}

}  // namespace screed::flash
