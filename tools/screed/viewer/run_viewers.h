// Shows a simulation as it runs, and a recorded run at any time of it.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/simulation/recorders.h"
#include "host_sim/run/simulation/run_loop.h"
#include "tools/screed/viewer/keyboard_driver.h"
#include "tools/screed/viewer/viewer_display.h"

namespace screed::viewer {

/// A simulation as it runs.
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

/// A recorded run.
class RecordedViewer {
 public:
  /// Throws InputError when the run cannot be read, or, then, when there is no screen for the
  /// window (require_screen()); RunError when the window cannot be opened.
  RecordedViewer(const std::filesystem::path& run, const ViewerOptions& options);

  /// Until the user closes the window, the frames asked for are shown, or the picture is saved.
  /// Throws RunError when a picture could not be written. A film that does not come to its end is
  /// removed.
  void run();
  const FrameTimes& times() const { return display_->times(); }
  /// What was last shown beside the ground.
  const Status& status() const { return display_->status(); }

 private:
  const SessionReader& session() const { return robots_.front().session; }
  /// A robot of the run: its session, and its way through all of it.
  struct Recorded {
    explicit Recorded(SessionReader of) : session(std::move(of)) {}

    SessionReader session;
    std::vector<SimFrame> block;
    uint64_t block_first = 0;
    std::vector<TrailPoint> trail;
    std::vector<std::pair<double, double>> travel_m;  ///< of the tracks, at each point of the trail
  };

  void read_trail(Recorded& robot);
  void go_to(double time_s);
  static const SimFrame& frame(Recorded& robot, uint64_t row);
  void show_terrain_after(uint64_t ticks);
  void take_jumps();
  void capture_frames();
  void play();

  std::vector<Recorded> robots_;  ///< at least one
  ViewerOptions options_;
  std::optional<ViewerDisplay> display_;
  std::optional<HeightMap> after_;  ///< when the heights of the ticks were not recorded
  bool at_end_ = false;             ///< the ground is that of the end
  std::string algorithm_;           ///< of the experiment
  std::vector<HeightChange> changes_;
  double tick_s_ = 0.01;
  double duration_s_ = 0.0;
  double time_s_ = 0.0;
};

}  // namespace screed::viewer
