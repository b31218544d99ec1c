// Sleeping to a point in time, so that errors of single sleeps do not add up.
#include "host_sim/run/simulation/pacer.h"

#include <thread>

namespace screed {

WallClock::Time WallClock::now() const {
  return std::chrono::steady_clock::now();
}

void WallClock::sleep_until(Time time) {
  std::this_thread::sleep_until(time);
}

Pacer::Pacer(WallClock& clock, bool realtime)
    : clock_(clock), realtime_(realtime), begin_(clock.now()) {}

void Pacer::wait_until(double simulated_s) {
  if (!realtime_) return;
  clock_.sleep_until(begin_ + std::chrono::duration_cast<WallClock::Time::duration>(
                                  std::chrono::duration<double>(simulated_s)));
}

double Pacer::elapsed_s() const {
  return std::chrono::duration<double>(clock_.now() - begin_).count();
}

}  // namespace screed
