// Out of an experiment's text.
#include "host_sim/run/experiment/run_setup.h"

#include <optional>
#include <string>
#include <system_error>

#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/run/experiment/robot_model.h"

namespace screed {

namespace {

constexpr const char* kSource = "the session's experiment";

double number_of(const IniEntry& entry) {
  const std::optional<double> number = finite_number<double>(entry.value);
  if (number.has_value()) return *number;
  throw InputError(std::string(kSource) + ", line " + std::to_string(entry.line) + ": " +
                   entry.section + "." + entry.key + " = '" + entry.value + "' is no number");
}

}  // namespace

bool is_secret(const IniEntry& entry) {
  return entry.section == "radio" && entry.key == "key";
}

RunSetup setup_of(const SessionInfo& info, const std::filesystem::path& folder) {
  RunSetup setup;
  setup.experiment.folder = folder;
  setup.experiment.experiment.name = info.experiment_name;
  setup.experiment.experiment.seed = info.seed;
  // Not read_experiment(): a session of an older program may have keys that are gone by now.
  for (const IniEntry& entry : read_ini_text(info.experiment_text, kSource)) {
    const std::string name = entry.section + "." + entry.key;
    if (name == "vehicle.model") setup.experiment.vehicle.model = entry.value;
    if (name == "vehicle.chassis_link") setup.experiment.vehicle.chassis_link = entry.value;
    if (name == "vehicle.wheel_links") setup.experiment.vehicle.wheel_links = entry.value;
    if (name == "vehicle.imu_link") setup.experiment.vehicle.imu_link = entry.value;
    if (name == "vehicle.tracks") setup.experiment.vehicle.tracks = entry.value == "true";
    if (name == "vehicle.leg_angle" && !entry.value.empty()) {
      setup.experiment.vehicle.leg_angle_deg = number_of(entry);
    }
    if (name == "experiment.algorithm") setup.experiment.experiment.algorithm = entry.value;
    if (name == "experiment.flatness" && !entry.value.empty()) {
      setup.experiment.experiment.flatness_deg = number_of(entry);
    }
    if (name == "map.model") setup.experiment.map.model = entry.value;
    if (name == "map.particle_radius" && !entry.value.empty()) {
      setup.experiment.map.particle_radius_m = number_of(entry);
    }
    if (name == "soil.preset") setup.soil = entry.value;
  }
  return setup;
}

Assembly robot_model(const RunSetup& setup, const std::string& board,
                     const std::optional<std::filesystem::path>& file) {
  if (file) return make_robot_model(setup.experiment, board, file);
  // Where the experiment's file lay is not recorded: most runs lie below that folder, or are looked
  // at from it.
  constexpr int kFoldersUp = 3;
  std::error_code error;
  Experiment experiment = setup.experiment;
  std::filesystem::path folder = std::filesystem::absolute(experiment.folder, error);
  for (int up = 0; up <= kFoldersUp + 1; ++up) {
    if (up > kFoldersUp) folder = std::filesystem::current_path(error);
    if (std::filesystem::is_regular_file(folder / experiment.vehicle.model, error)) {
      experiment.folder = folder;
      break;
    }
    folder = folder.parent_path();
  }
  return make_robot_model(experiment, board);
}

}  // namespace screed
