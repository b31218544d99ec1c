// How a run has leveled, in one picture: the ground before and after it in the same colours, and
// the curves of relief and transport over time.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/core/sim_frame.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {

/// The text of an SVG file. `title`: of which run. `points`: its leveling curve, the first from
/// before it; throws InputError when there are less than two.
std::string leveling_svg(const std::string& title, const HeightField& before,
                         const HeightField& after, std::span<const LevelingPoint> points);

// The pictures of a run: the terrain before, after it with the driven path, what has changed, and
// how it was leveled. Made at its end, and again from its session.

/// The terrain before and after a run, as TerrainMeasure::surface() gives it.
struct RunSurfaces {
  HeightField before;
  HeightField after;
};

/// What the robots did between them.
struct DrivenRun {
  double time_s = 0.0;
  /// At the end; the states of their paths are those of the leveling algorithm (LevelingState).
  std::vector<PictureRobot> robots;
  std::vector<LevelingPoint> leveling;
};

/// Adds the next robot. `last`: the frame of its last tick; of no use for a path without a point.
void add_robot(std::vector<PathPoint> path, const SimFrame& last,
               const std::optional<RobotShape>& shape, DrivenRun& run);

/// The end of a path, no longer than so much; all of a path that is no longer. A step of more than
/// half a bed is none that was driven: it leads over the edge of a wrapped one.
std::span<const PathPoint> last_stretch(std::span<const PathPoint> path, double length_m,
                                        double bed_m);

/// Writes terrain_before.png and terrain_after.png into the folder, both in the same colours for
/// the same height, the second with the driven path, of a long one with its end, which leaves the
/// ground to be seen; and where the terrain is deformable or has changed terrain_change.png, and
/// leveling.png when the run has a leveling curve. Returns the files. Throws RunError when one
/// cannot be written.
std::vector<std::filesystem::path> write_run_pictures(const std::filesystem::path& folder,
                                                      const Experiment& experiment,
                                                      const RunSurfaces& terrain,
                                                      const DrivenRun& run);

/// The same pictures from a recorded run, byte by byte; without a shape the path's end stands for
/// the robot. `sessions`: of its robots, at least one. No file when the first one lacks one of the
/// terrains. Throws as above, InputError when a session is damaged.
std::vector<std::filesystem::path> export_run_pictures(const std::filesystem::path& folder,
                                                       std::span<const SessionReader> sessions,
                                                       const std::optional<RobotShape>& shape);

}  // namespace screed
