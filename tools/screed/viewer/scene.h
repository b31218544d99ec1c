// What is to be seen in one frame of the viewer: plain data, made by whoever knows a simulation or
// a recording, drawn by whoever knows a canvas.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/render/picture/terrain_picture.h"
#include "tools/screed/viewer/ground_view.h"
#include "tools/screed/viewer/layout.h"
#include "tools/screed/viewer/slope_statistics.h"

namespace screed::viewer {

/// A place of the driven path; its state colours the path from here on.
struct TrailPoint {
  float x_m;
  float y_m;
  uint8_t state;  ///< LevelingState
};

struct RobotMarker {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;
  /// How far the tracks have run, m.
  double travel_left_m = 0.0;
  double travel_right_m = 0.0;
};

/// A robot and its way.
struct ShownRobot {
  RobotMarker robot;
  std::vector<TrailPoint> trail;
  uint8_t state = 0;  ///< LevelingState
};

/// What is written beside the ground. Compared to know whether to write it again.
struct Status {
  struct Motion {
    double speed_m_per_s = 0.0;  ///< true, of the chassis, forward
    double turn_rad_per_s = 0.0;
    double wanted_m_per_s = 0.0;
    double wanted_rad_per_s = 0.0;
    double pitch_rad = 0.0;
    double roll_rad = 0.0;
    double heading_rad = 0.0;
    double slip_left = 0.0;
    double slip_right = 0.0;
    std::optional<double> sinkage_m;
    double battery_v = 0.0;

    bool operator==(const Motion&) const = default;
  };
  /// As TerrainChange has it.
  struct VolumeMoved {
    double cut_m3 = 0.0;
    double fill_m3 = 0.0;
    double moved_m3 = 0.0;
    double deepest_cut_m = 0.0;
    double deepest_fill_m = 0.0;

    bool operator==(const VolumeMoved&) const = default;
  };
  struct Terrain {
    SlopeFigures before;
    SlopeFigures now;
    double flat_limit_deg = 0.0;
    bool loose = false;                 ///< the ground can change
    std::optional<VolumeMoved> volume;  ///< when the colours show the change

    bool operator==(const Terrain&) const = default;
  };

  /// Of points of the leveling curve.
  struct Leveling {
    double level_deviation_m = 0.0;  ///< RMS of the heights about level
    double roughness_m = 0.0;
    double flat = 0.0;               ///< share of cells flat at robot scale, 0..1
    std::optional<double> progress;  ///< the last one measured

    bool operator==(const Leveling&) const = default;
  };

  std::string title;
  std::string subtitle;
  double time_s = 0.0;
  double duration_s = 0.0;
  std::string pace;          ///< "x 1", "paused"
  int state = 0;             ///< RobotState
  int leveling_state = 0;    ///< LevelingState
  uint32_t states_seen = 0;  ///< bits of the LevelingStates of the path
  int faults = 0;
  Motion motion;
  Terrain terrain;
  std::optional<Leveling> leveling_before;
  std::optional<Leveling> leveling_now;
  std::string notice;  ///< one line the user should know
  std::string driver;  ///< what the user who drives should know
  std::string keys;    ///< the line at the foot

  bool operator==(const Status&) const = default;
};

struct Scene {
  const TerrainImage* ground = nullptr;
  TerrainPlacement place{};
  MapRectangle bed{};
  Shading shading = Shading::kHeight;
  Camera camera;
  const RobotShape* shape = nullptr;
  std::span<const ShownRobot> robots;  ///< the panel tells about the first
  size_t trail_points = 0;             ///< of each trail, that many
  bool show_trail = true;
  Status status;
  std::vector<std::string> badges;  ///< short words over the ground: paused, follow
  bool show_timeline = false;       ///< a bar to scrub on, else only how far the run has come
  const std::vector<HelpLine>* help = nullptr;  ///< shown when not null
};

}  // namespace screed::viewer
