// Titles, legend and outline of a run's pictures.
#include "host_sim/run/simulation/run_pictures.h"

#include <cmath>
#include <string>
#include <utility>

#include "host_sim/run/simulation/names.h"

namespace screed {

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
  options.state_names = leveling_state_names();
  options.path = std::move(path);
  const ChassisState chassis = plant.vehicle().chassis();
  options.robot = RobotOutline{chassis.pose.translation().x(), chassis.pose.translation().y(),
                               attitude_of(chassis.pose.linear()).heading, shape};
  write_height_map_picture(folder / "terrain_after.png", terrain.after, options);
}

}  // namespace screed
