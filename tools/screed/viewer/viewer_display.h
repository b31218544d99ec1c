// What the viewers of a running and of a recorded simulation share: the ground as it is shown, the
// path, the camera, the window, pictures and recorded frames.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hal/sample.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/outcome.h"
#include "tools/screed/viewer/drawing.h"
#include "tools/screed/viewer/input.h"
#include "tools/screed/viewer/keyboard_driver.h"
#include "tools/screed/viewer/window.h"

namespace screed::viewer {

struct ViewerOptions {
  bool window = true;
  int width_px = 1280;
  int height_px = 800;
  double pace = 1.0;                    ///< simulated seconds a second; 0: as fast as it goes
  std::optional<uint64_t> frames;       ///< draw so many, each pace / 60 s on, and close
  std::string screenshot;               ///< a PNG to write; empty: none
  std::optional<double> screenshot_at;  ///< the time it shows, s; without it the end
  std::string frames_dir;               ///< folder for PNGs from the first frame on; empty: none
  Shading shading = Shading::kHeight;
  bool follow = false;
  std::optional<double> span_m;  ///< width of the ground that is seen at first; without it all
  std::vector<ScriptedKey> script;
  TaskProgress progress;  ///< of reading a run and drawing its frames; may be empty, may end it
};

/// Throws InputError when the screenshot is to show a time after the end. `what` lasts duration_s.
void check_screenshot_time(const ViewerOptions& options, double duration_s,
                           const std::string& what);

/// What does not change while something is shown.
struct DisplaySetup {
  std::string title;
  std::string terrain;  ///< as the subtitle says it
  uint64_t seed = 0;
  double duration_s = 0.0;
  bool loose = false;      ///< the ground can change
  bool soft = false;       ///< the robot sinks in
  TerrainMeasure measure;  ///< what the figures of the terrain are of
  bool recorded = false;
  RobotShape shape;
};

/// What the experiment says of it; `soil`: its preset, `robot`: its model. Not recorded.
DisplaySetup display_setup(const Experiment& experiment, const std::string& soil,
                           const Assembly& robot);

/// The place of this frame.
TrailPoint trail_point(const SimFrame& frame);

/// Ticks from one point of the path to the next.
inline constexpr uint64_t kTrailTicks = kTickRate_hz / 10;

/// How long frames took, for those who count them.
struct FrameTimes {
  uint64_t frames = 0;
  double drawing_s = 0.0;
  double showing_s = 0.0;
  double total_s = 0.0;  ///< from the first to the last frame

  std::string text() const;
};

class ViewerDisplay {
 public:
  static constexpr double kFramesPerSecond = 60.0;

  /// Opens the window, if there is to be one. Changes and the figures of the start are those of
  /// `before`, which on soil is not yet the ground that the robot stands on; both of the same grid.
  /// Throws RunError when that fails.
  ViewerDisplay(const ViewerOptions& options, DisplaySetup setup, const HeightField& before,
                const HeightField& ground);

  const ViewerOptions& options() const { return options_; }
  Controls& controls() { return controls_; }
  /// The ground as it is shown.
  const HeightField& ground() const { return ground_; }
  /// What is written beside it, as it was last drawn.
  const Status& status() const { return status_; }

  /// The ground has changed: by that much, since the last call.
  void change_terrain(std::span<const HeightChange> changes);
  /// For their trails, all of one length, and travel.
  std::vector<ShownRobot>& robots() { return robots_; }
  /// How many points of the trails are shown; all without a call.
  void show_trail_points(size_t points) { trail_points_ = points; }
  void set_notice(std::string notice) { status_.notice = std::move(notice); }
  /// Who drives, and what a user who drives should know.
  void set_driver(const Driver& driver, std::string notice = "");
  /// The next point of the leveling curve; of those not after the moment shown the last one is
  /// shown, beside the first.
  void add_leveling(const LevelingPoint& point);
  /// The moment to be shown: a frame of each robot.
  void set_frames(std::span<const SimFrame> frames);

  /// Takes what the user does; waits at most so long for it. A time of the run goes with it: the
  /// script's keys up to it are pressed.
  void handle_input(double time_s, int wait_ms);
  /// Frames are recorded and the next one is due: 25 a second at the pace that is set.
  bool capture_is_due() const;
  /// Draws, shows, records. A picture that cannot be written throws nothing: what is shown goes on,
  /// a film ends, and failure() says why.
  void show();
  /// All frames that were asked for have been shown.
  bool all_shown() const {
    return options_.frames.has_value() && times_.frames >= *options_.frames;
  }
  /// The screenshot of the options, when it is due or when this is the end; once.
  void save_when_due(double time_s, bool end);
  /// Why the first picture that could not be written was not; empty: all were.
  const std::string& failure() const { return failure_; }
  /// Removes the frames written to ViewerOptions::frames_dir, of a film that will not be whole. A
  /// folder that was made for them goes with this object.
  void discard_film();

  const FrameTimes& times() const { return times_; }

 private:
  void handle_event(const InputEvent& event);
  void handle_mouse(const InputEvent& event);
  Scene scene();
  /// exact: with the figures of this very moment.
  void draw(bool exact);
  /// The terrain whose figures are shown.
  HeightField surface() const;
  /// Slopes, and the volume moved where the colours show it.
  void measure_terrain(bool exact);
  void show_leveling();
  void save_on_demand();
  /// Whether `write` did not throw RunError, which is a notice and failure().
  bool attempt(const std::function<void()>& write);
  void write_frame();
  /// Makes the folder of the frames, which must hold none yet.
  void begin_frames();

  ViewerOptions options_;
  DisplaySetup setup_;
  HeightField ground_;
  TerrainImage image_;
  HeightField before_;  ///< the surface from which changes count
  std::vector<LevelingPoint> leveling_;
  SlopeStatistics slopes_;  ///< of the terrain as it is
  bool measured_ = false;   ///< the figures on particles are up to date
  Controls controls_;
  Drawing drawing_;
  std::optional<Window> window_;
  Camera camera_;
  Status status_;
  Status::Motion motion_;
  std::vector<HelpLine> help_;
  std::vector<ShownRobot> robots_;
  std::optional<size_t> trail_points_;
  std::optional<Pixel> drag_;
  bool scrubbing_ = false;
  double scripted_until_s_ = -1.0;
  bool screenshot_saved_ = false;
  uint64_t pictures_ = 0;
  uint64_t captured_frames_ = 0;
  std::filesystem::path frames_folder_;  ///< once the first frame is written
  MadeFolders folders_;
  std::string failure_;
  std::optional<double> captured_until_s_;
  FrameTimes times_;
  std::chrono::steady_clock::time_point first_shown_;
};

}  // namespace screed::viewer
