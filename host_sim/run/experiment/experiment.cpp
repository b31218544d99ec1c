// Experiment files: read by the table of keys, and what no single key can tell.
#include "host_sim/run/experiment/experiment.h"

#include <algorithm>
#include <cmath>
#include <system_error>

#include "hal/sample.h"
#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/core/name_list.h"
#include "host_sim/run/experiment/experiment_keys.h"
#include "host_sim/run/experiment/experiment_table.h"
#include "host_sim/run/experiment/robot_sections.h"

namespace screed {
namespace {

/// Keys of a kind of ground, or of edges, that the experiment does not have.
bool decides_nothing(const ExperimentKey& key, const MapSection& map) {
  if (key.name == "wall_friction") return map.edge() != BedEdge::kWalled;
  if (key.section == "soil") return !map.is_soil();
  return !map.of_particles() &&
         (key.section == "particles" || key.section == "raygrid" || key.name == "particle_radius");
}

std::string full_name(const std::string& section, const std::string& key) {
  return section.empty() ? key : "[" + section + "] " + key;
}

/// `where` names the entry's place in messages.
void apply(Experiment& experiment, const IniEntry& entry, const std::string& where) {
  const ExperimentKey& key = find_experiment_key(entry.section, entry.key, where);
  if (!key.set(experiment, entry.value)) {
    throw InputError(where + ": " + full_name(entry.section, entry.key) + " = '" + entry.value +
                     "' is not allowed; expected " + key.allowed +
                     (key.unit.empty() ? "" : " (" + key.unit + ")"));
  }
}

/// Whether a file is one of the thesis' simulator: it says so, or it has the key that only those
/// files have. Leaves a note.
bool is_sandbox(const std::vector<IniEntry>& entries, const std::string& source,
                Experiment& experiment) {
  const auto find = [&](const char* key) {
    return std::find_if(entries.begin(), entries.end(), [&](const IniEntry& entry) {
      return entry.section.empty() && entry.key == key;
    });
  };
  const auto units = find(kUnitsKey);
  const auto chrono = find(kSandboxKey);
  if (chrono == entries.end()) return units != entries.end() && units->value == "sandbox";
  const std::string where = source + ":" + std::to_string(chrono->line) + ": ";
  if (units != entries.end()) {
    experiment.notes.push_back(where + kSandboxKey + " is not used");
    return units->value == "sandbox";
  }
  experiment.notes.push_back(where + kSandboxKey +
                             " is not used; with it the file counts as one of Sandbox: lengths in "
                             "units of 1/12 m, y upwards ('units = si' says otherwise)");
  return true;
}

/// An entry of a Sandbox file (thesis Figure 5.3) as one of ours: lengths from its unit of 1/12 m,
/// axes from x east, y up, z south. What is no number stays for the ordinary check.
IniEntry from_sandbox(IniEntry entry) {
  constexpr double kUnit_m = 1.0 / kSandboxUnitsPerMetre;
  struct Length {
    const char* section;
    const char* key;
    const char* ours;
    double factor;
  };
  static constexpr Length kLengths[] = {
      {"vehicle", "x", "x", kUnit_m},
      {"vehicle", "y", "z", kUnit_m},
      {"vehicle", "z", "y", -kUnit_m},
      {"map", "scale", "scale", kUnit_m},
      {"map", "size", "size", kUnit_m},
      {"map", "smoothing", "smoothing", kUnit_m},
      {"map", "particle_radius", "particle_radius", kUnit_m},
      {"raygrid", "resolution", "resolution", 1.0 / kUnit_m},
  };
  if (entry.section == "map" && entry.key == "model" && entry.value == "particle")
    entry.value = "particles";
  if (entry.section == "experiment" && entry.key == "algorithm" && entry.value == "random")
    entry.value = kTrainingDriveName;
  for (const Length& length : kLengths) {
    double value = 0.0;
    if (entry.section != length.section || entry.key != length.key) continue;
    entry.key = length.ours;
    if (parse_number(entry.value, value)) entry.value = shortest(value * length.factor);
    break;
  }
  return entry;
}

/// The n of Algorithm 5, from frames or from the duration.
void set_training_length(Experiment& experiment, const std::string& source) {
  auto& frames = experiment.experiment.frames;
  if (!frames.has_value()) {
    const double wanted = std::floor(experiment.experiment.duration_s * kTickRate_hz / 8.0) * 8.0;
    if (wanted < 8.0 || wanted > kMaxFrames) {
      throw InputError(source +
                       ": [experiment] duration = " + shortest(experiment.experiment.duration_s) +
                       " s: algorithm training_drive needs 0.08 s to " +
                       shortest(kMaxFrames / double{kTickRate_hz}) + " s");
    }
    frames = static_cast<uint32_t>(wanted);
  }
  experiment.parameters.training_block() = static_cast<int16_t>(*frames / 8);
}

void check_robots(const Experiment& experiment, const std::string& source) {
  const RobotsSection& robots = experiment.robots;
  if (robots.count == 1) return;
  const std::string count = ": [robots] count = " + std::to_string(robots.count);
  if (experiment.experiment.algorithm == kTrainingDriveName) {
    throw InputError(source + count + ": algorithm " + kTrainingDriveName +
                     " records one robot; allowed is 1");
  }
  if ((robots.placement == "list") == robots.places.empty()) {
    throw InputError(source + count + ": places belong to placement = list, which needs them");
  }
  if (robots.placement == "list" && places_in(robots.places)->size() != robots.count) {
    throw InputError(source + count + ", but places has " +
                     std::to_string(places_in(robots.places)->size()));
  }
}

void check_parameters(const Parameters& p, const std::string& source) {
  if (p.walk_speed_min() > p.walk_speed_max()) {
    throw InputError(source +
                     ": [parameters] walk_speed_min = " + std::to_string(p.walk_speed_min()) +
                     " is above walk_speed_max = " + std::to_string(p.walk_speed_max()));
  }
  if (p.walk_leg_min() > p.walk_leg_max()) {
    throw InputError(source + ": [parameters] walk_leg_min = " + std::to_string(p.walk_leg_min()) +
                     " is above walk_leg_max = " + std::to_string(p.walk_leg_max()));
  }
}

/// What robots have of their own.
void check_robot_sections(const Experiment& experiment, const std::string& source) {
  for (const auto& [place, value] : experiment.of_robots) {
    const auto [robot, key] = place;
    const std::string where = source + ": [" + section_of_robot(robot) + "]";
    if (robot >= experiment.robots.count || experiment.robots.count == 1) {
      throw InputError(where + ": [robots] count = " + std::to_string(experiment.robots.count) +
                       "; sections of robots are for those of several, from [robot_0] on");
    }
    const Experiment own = experiment_of_robot(experiment, robot);
    if (own.experiment.algorithm == kTrainingDriveName) {
      throw InputError(where + " algorithm = " + kTrainingDriveName +
                       ": that records one robot, alone");
    }
    check_parameters(own.parameters, where);
  }
}

/// What no single key can tell.
void check(const Experiment& experiment, const std::string& source) {
  check_robots(experiment, source);
  check_robot_sections(experiment, source);
  check_parameters(experiment.parameters, source);
  if (!experiment.map.filename.empty() && experiment.map.ramp_deg != 0.0) {
    throw InputError(source + ": [map] has both filename and ramp; a ramp needs no image");
  }
  if (experiment.map.ramp_deg != 0.0 && experiment.map.wrap()) {
    throw InputError(source +
                     ": [map] has both ramp and edges = wrap; a slope does not repeat: allowed are "
                     "edges = open or walls");
  }
  if (experiment.map.of_particles() && experiment.map.edge() == BedEdge::kOpen) {
    throw InputError(source +
                     ": [map] edges = open: particles would roll off the bed; with model = " +
                     experiment.map.model + " edges = walls or wrap is allowed");
  }
}

}  // namespace

CommandKey ground_key_of(const Experiment& experiment) {
  const std::string& key = experiment.radio.key;
  return key.empty() || key == kNoCommandKey ? test_key() : parse_key(key, "[radio] key");
}

Credentials credentials_of(const Experiment& experiment) {
  Credentials credentials = credentials_of(ground_key_of(experiment), experiment.radio.boot_epoch);
  credentials.key_set = experiment.radio.key != kNoCommandKey;
  return credentials;
}

std::string Experiment::text() const {
  const Experiment defaults;
  std::string text;
  std::string section;
  for (const ExperimentKey& key : experiment_keys()) {
    const std::optional<std::string> value = key.get(*this);
    if (!value.has_value()) continue;
    if (!key.default_written && value == key.get(defaults)) continue;
    if (decides_nothing(key, map)) continue;
    if (key.section != section) text += "\n[" + key.section + "]\n";
    section = key.section;
    text += key.name + " = " + *value + "\n";
  }
  std::optional<size_t> robot;
  for (const auto& [place, value] : of_robots) {
    if (robot != place.first) text += "\n[" + section_of_robot(place.first) + "]\n";
    robot = place.first;
    text += experiment_keys()[place.second].name + " = " + value + "\n";
  }
  return text;
}

std::filesystem::path find_experiment(const std::filesystem::path& name) {
  std::error_code error;
  const bool is_file =
      std::filesystem::exists(name, error) && !std::filesystem::is_directory(name, error);
  if (name.has_parent_path() || name.has_extension() || is_file) return name;
  std::vector<std::string> names;
  for (const auto& entry :
       std::filesystem::directory_iterator(data_folders().data / "experiments")) {
    if (entry.path().extension() != ".ini") continue;
    if (entry.path().stem() == name) return entry.path();
    names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  throw InputError(
      name.string() +
      ": no such file, and no experiment of that name comes with Screed: " + name_list(names));
}

Experiment read_experiment(const std::filesystem::path& path,
                           const std::vector<std::string>& overrides) {
  return read_experiment_row(path, {}, overrides);
}

Experiment read_experiment_row(const std::filesystem::path& name, const ExperimentRow& row,
                               const std::vector<std::string>& overrides) {
  const ExperimentFile file = read_experiment_file(name);
  std::vector<PlacedEntry> entries;
  for (const ExperimentRow::Value& value : row.values)
    entries.push_back({value.entry, row.where + ", column '" + value.column + "'"});
  for (const std::string& text : overrides) entries.push_back({parse_override(text), "--set"});
  return make_experiment(file, entries, row.where.empty() ? file.path.string() : row.where);
}

ExperimentFile read_experiment_file(const std::filesystem::path& name) {
  const std::filesystem::path path = find_experiment(name);
  return {path, read_ini_file(path)};
}

Experiment make_experiment(const ExperimentFile& file, const std::vector<PlacedEntry>& entries,
                           const std::string& whole) {
  Experiment experiment;
  const std::filesystem::path folder = file.path.parent_path();
  experiment.folder = folder.empty() ? std::filesystem::path(".") : folder;
  const std::string source = file.path.string();
  const bool sandbox = is_sandbox(file.entries, source, experiment);
  // Its terrains have no edges: who leaves on one side comes back on the other (thesis 5.1.4).
  if (sandbox) {
    experiment.map.edges = "wrap";
    experiment.particles.depth_m = 0.0;
  }
  for (const IniEntry& entry : file.entries)
    apply(experiment, sandbox ? from_sandbox(entry) : entry,
          source + ":" + std::to_string(entry.line));
  // A pixel's width is a length; of particles the key is a share.
  if (sandbox && experiment.map.xy_scale.has_value() && !experiment.map.of_particles())
    *experiment.map.xy_scale /= kSandboxUnitsPerMetre;
  for (const PlacedEntry& placed : entries) apply(experiment, placed.entry, placed.where);
  experiment.parameters.algorithm() = algorithm_number(experiment.experiment.algorithm);
  if (experiment.experiment.algorithm == kTrainingDriveName) set_training_length(experiment, whole);
  if (experiment.experiment.frames.has_value())
    experiment.experiment.duration_s = *experiment.experiment.frames / double{kTickRate_hz};
  check(experiment, whole);
  return experiment;
}

std::filesystem::path find_data_file(const Experiment& experiment, const std::string& name,
                                     const char* key, const char* kind) {
  const std::filesystem::path file(name);
  std::vector<std::filesystem::path> places;
  if (file.is_absolute()) {
    places = {file};
  } else {
    places = {experiment.folder / file, data_folders().data / kind / file};
  }
  std::string looked;
  for (const std::filesystem::path& place : places) {
    std::error_code error;
    if (std::filesystem::exists(place, error)) return place;
    looked += (looked.empty() ? "" : ", ") + place.lexically_normal().string();
  }
  throw InputError(std::string(key) + " = '" + name + "': no such file; looked for " + looked);
}

std::filesystem::path find_model_file(const Experiment& experiment, const std::string& board) {
  if (experiment.vehicle.model == "board") return board_model(board);
  // Figure 5.3 calls the chassis Dagu5.
  if (experiment.vehicle.model == "rover5" || experiment.vehicle.model == "Dagu5") {
    if (const auto rover = file_of_a_board("rover5.urdf")) return *rover;
  }
  std::string name = experiment.vehicle.model;
  if (!std::filesystem::path(name).has_extension()) name += ".urdf";
  return find_data_file(experiment, name, "[vehicle] model", "robots");
}

std::string experiment_key_table() {
  const Experiment defaults;
  std::string text;
  for (const ExperimentKey& key : experiment_keys()) {
    const std::optional<std::string> value = key.get(defaults);
    text += "| " + (key.section.empty() ? "" : "[" + key.section + "] ") + key.name + " | " +
            key.unit + " | " + value.value_or("") + " | " + key.allowed + " | " + key.meaning +
            " |\n";
  }
  return text;
}

}  // namespace screed
