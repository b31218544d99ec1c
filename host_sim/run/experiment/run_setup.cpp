// Out of an experiment's text.
#include "host_sim/run/experiment/run_setup.h"

#include <numbers>

#include "host_sim/core/ini_file.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"

namespace screed {

RunSetup setup_of(const SessionInfo& info, const std::filesystem::path& folder) {
  RunSetup setup;
  setup.experiment.folder = folder;
  setup.experiment.experiment.name = info.experiment_name;
  setup.experiment.experiment.seed = info.seed;
  // Not read_experiment(): a session of an older program may have keys that are gone by now.
  for (const IniEntry& entry : read_ini_text(info.experiment_text, "the session's experiment")) {
    const std::string name = entry.section + "." + entry.key;
    if (name == "vehicle.model") setup.experiment.vehicle.model = entry.value;
    if (name == "vehicle.tracks") setup.experiment.vehicle.tracks = entry.value == "true";
    if (name == "vehicle.leg_angle" && !entry.value.empty()) {
      setup.experiment.vehicle.leg_angle_deg = std::stod(entry.value);
    }
    if (name == "experiment.algorithm") setup.experiment.experiment.algorithm = entry.value;
    if (name == "experiment.flatness" && !entry.value.empty()) {
      setup.experiment.experiment.flatness_deg = std::stod(entry.value);
    }
    if (name == "map.model") setup.experiment.map.model = entry.value;
    if (name == "soil.preset") setup.soil = entry.value;
  }
  return setup;
}

Assembly robot_model(const RunSetup& setup, const std::string& board,
                     const std::optional<std::filesystem::path>& file) {
  constexpr double kRadPerDeg = std::numbers::pi / 180.0;
  UrdfOptions urdf;
  const auto& leg_angle_deg = setup.experiment.vehicle.leg_angle_deg;
  if (leg_angle_deg) urdf.leg_angle_rad = *leg_angle_deg * kRadPerDeg;
  return import_urdf(file ? *file : find_model_file(setup.experiment, board), urdf);
}

}  // namespace screed
