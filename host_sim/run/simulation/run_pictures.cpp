// Titles, legend and outline of a run's pictures.
#include "host_sim/run/simulation/run_pictures.h"

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "firmware/leveling/leveling.h"
#include "host_sim/run/simulation/names.h"

namespace screed {
namespace {

/// Names the states that occurred, in their order, and renumbers the path's states to match.
std::vector<std::string> make_legend(std::vector<PathPoint>& path) {
  std::array<bool, kLevelingStates> occurred{};
  for (const PathPoint& point : path) occurred.at(point.state) = true;
  std::vector<std::string> names;
  std::array<size_t, kLevelingStates> row{};
  for (size_t state = 0; state < kLevelingStates; ++state) {
    row.at(state) = names.size();
    if (occurred.at(state)) {
      names.emplace_back(leveling_state_name(static_cast<LevelingState>(state)));
    }
  }
  for (PathPoint& point : path) point.state = row.at(point.state);
  return names;
}

}  // namespace

void write_run_pictures(const std::filesystem::path& folder, const Experiment& experiment,
                        const RunSurfaces& terrain, const Environment& plant,
                        std::vector<PathPoint> path, const RobotShape& shape) {
  const std::string& name = experiment.experiment.name;
  const std::string run =
      std::to_string(std::lround(plant.time_s())) + " s of " + experiment.experiment.algorithm;
  PictureOptions options;
  if (plant.is_deformable()) {
    // Without the path, which would hide the tracks below it.
    options.title = name + ": change by " + run;
    write_difference_picture(folder / "terrain_change.png", terrain.before, terrain.after, options);
  }
  options.heights = common_range(terrain.before, terrain.after);
  options.title = name + ": before";
  write_height_map_picture(folder / "terrain_before.png", terrain.before, options);

  options.title = name + ": after " + run;
  options.state_names = make_legend(path);
  options.path = std::move(path);
  const ChassisState chassis = plant.vehicle().chassis();
  options.robot = RobotOutline{chassis.pose.translation().x(), chassis.pose.translation().y(),
                               attitude_of(chassis.pose.linear()).heading, shape};
  write_height_map_picture(folder / "terrain_after.png", terrain.after, options);
}

}  // namespace screed
