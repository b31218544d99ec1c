// Shows a recorded run, at any time of it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/run/session/session_reader.h"
#include "tools/screed/viewer/viewer_display.h"

namespace screed::viewer {

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
