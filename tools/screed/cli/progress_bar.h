// A progress bar on a terminal; on anything else, a line now and then. Looks at the wall clock,
// decides nothing.
#pragma once

#include <chrono>
#include <ostream>
#include <string>

namespace screed {

class ProgressBar {
 public:
  explicit ProgressBar(std::ostream& out);

  /// Shows simulated time, real-time factor since the first call, the time that is left at this
  /// speed, and `note`. Cheap when called often: draws ten times a second at most.
  void show(double time_s, double duration_s, const std::string& note);
  /// The same for work that is not simulated time: the share that is done, 0 to 1.
  void show_share(double share, const std::string& note);
  /// Draws the last state and ends the line.
  void finish();
  /// Removes the bar from a terminal; lines elsewhere stay.
  void clear();

 private:
  void draw();

  std::ostream& out_;
  bool terminal_;
  bool begun_ = false;
  bool visible_ = false;
  bool is_share_ = false;
  double time_s_ = 0.0;
  double duration_s_ = 0.0;
  double begin_time_s_ = 0.0;
  std::string note_;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point shown_;
  std::chrono::steady_clock::time_point drawn_;
};

}  // namespace screed
