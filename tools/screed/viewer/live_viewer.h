// Shows a simulation as it runs.
#pragma once

#include <chrono>
#include <optional>
#include <span>

#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/recorders.h"
#include "host_sim/run/simulation/run_loop.h"
#include "tools/screed/viewer/keyboard_driver.h"
#include "tools/screed/viewer/viewer_display.h"

namespace screed::viewer {

class LiveViewer : public SimulationObserver {
 public:
  /// `driver` receives what the arrow keys request; it must outlive this. `end_run` is called when
  /// the user closes the window.
  LiveViewer(const Experiment& experiment, const std::string& board, const ViewerOptions& options,
             KeyboardDriver& driver, std::function<void()> end_run);

  void on_begin(const HeightField& before, const HeightField& ground) override;
  void on_tick(std::span<const SimFrame> frames, const HeightField& ground) override;
  void on_leveling(const LevelingPoint& point) override;
  void on_end() override;

  /// After the run: shows how it ended until the user closes the window.
  void hold(const std::string& notice);
  /// None when the run ended before its first tick.
  FrameTimes times() const { return display_.has_value() ? display_->times() : FrameTimes(); }
  /// Why a picture could not be written; empty: all were.
  std::string failure() const { return display_.has_value() ? display_->failure() : ""; }
  /// What the window showed last beside the ground; after on_begin().
  const Status& status() const { return display_.value().status(); }

 private:
  using Clock = std::chrono::steady_clock;

  void steer();
  void show_counted(double time_s);
  void keep_pace(double time_s);

  ViewerOptions options_;
  DisplaySetup setup_;
  KeyboardDriver& driver_;
  std::function<void()> end_run_;
  std::optional<HeightWatch> watch_;
  std::optional<ViewerDisplay> display_;
  uint64_t ticks_ = 0;
  double time_s_ = 0.0;
  double next_show_s_ = 0.0;  ///< of the run, when frames are counted
  Clock::time_point next_show_{};
  /// The pace is kept from here on.
  std::optional<Clock::time_point> anchor_;
  double anchor_s_ = 0.0;
  double anchor_pace_ = 0.0;
};

}  // namespace screed::viewer
