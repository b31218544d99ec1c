// Keeps simulated time from outrunning the clock on the wall (--realtime), and tells how long a run
// has taken. Decides no result: a run is the same at every pace.
#pragma once

#include <chrono>

namespace screed {

/// The clock on the wall, which tests replace.
class WallClock {
 public:
  using Time = std::chrono::steady_clock::time_point;

  WallClock() = default;
  WallClock(const WallClock&) = delete;
  WallClock& operator=(const WallClock&) = delete;
  virtual ~WallClock() = default;

  /// Never goes back.
  virtual Time now() const;
  /// Returns at once when the time has passed already.
  virtual void sleep_until(Time time);
};

class Pacer {
 public:
  /// Time begins now. Without `realtime` nothing ever waits. The clock must outlive the pacer.
  Pacer(WallClock& clock, bool realtime);

  /// Waits until so much of the clock's time has passed since the beginning, s. A run that is late
  /// goes on at full speed until it has caught up.
  void wait_until(double simulated_s);

  /// Since the beginning, s.
  double elapsed_s() const;

 private:
  WallClock& clock_;
  bool realtime_;
  WallClock::Time begin_;
};

}  // namespace screed
