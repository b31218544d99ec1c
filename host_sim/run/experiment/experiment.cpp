// Experiment files: read by the table of keys, and what no single key can tell.
#include "host_sim/run/experiment/experiment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <system_error>

#include "hal/sample.h"
#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
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

/// `where` names the entry's place in messages; `sandbox`: it is of a file of the thesis'
/// simulator.
void apply(Experiment& experiment, const IniEntry& written, const std::string& where,
           bool sandbox = false) {
  const IniEntry entry = sandbox ? from_sandbox(written) : written;
  const ExperimentKey& key = find_experiment_key(entry.section, entry.key, where);
  if (!key.set(experiment, entry.value)) {
    throw InputError(where + ": " + full_name(entry.section, entry.key) + " = '" + entry.value +
                     "' is not allowed; expected " + key.allowed +
                     (key.unit.empty() ? "" : " (" + key.unit + ")") +
                     (entry.value == written.value
                          ? ""
                          : "; written is '" + written.value + "' in Sandbox's units of 1/12 m"));
  }
  experiment.places[full_name(entry.section, entry.key)] = where;
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

/// The n of Algorithm 5, from frames or from the duration.
void set_training_length(Experiment& experiment) {
  auto& frames = experiment.experiment.frames;
  if (!frames.has_value()) {
    const double wanted = std::floor(experiment.experiment.duration_s * kTickRate_hz / 8.0) * 8.0;
    if (wanted < 8.0 || wanted > kMaxFrames) {
      throw InputError("[experiment] duration = " + shortest(experiment.experiment.duration_s) +
                       " s: algorithm training_drive needs 0.08 s to " +
                       shortest(kMaxFrames / double{kTickRate_hz}) + " s");
    }
    frames = static_cast<uint32_t>(wanted);
  }
  experiment.parameters.training_block() = static_cast<int16_t>(*frames / 8);
}

void check_robots(const Experiment& experiment) {
  const RobotsSection& robots = experiment.robots;
  if (robots.count == 1) return;
  const std::string count = "[robots] count = " + std::to_string(robots.count);
  if (experiment.experiment.algorithm == kTrainingDriveName) {
    throw InputError(count + ": algorithm " + kTrainingDriveName +
                     " records one robot; allowed is 1");
  }
  if ((robots.placement == "list") == robots.places.empty()) {
    throw InputError(count + ": places belong to placement = list, which needs them");
  }
  if (robots.placement == "list" && places_in(robots.places)->size() != robots.count) {
    throw InputError(count + ", but places has " +
                     std::to_string(places_in(robots.places)->size()));
  }
}

/// section: where their keys stand.
void check_parameters(const Parameters& p, const std::string& section) {
  const auto check = [&section](const char* least, int low, const char* most, int high) {
    if (low <= high) return;
    throw InputError("[" + section + "] " + least + " = " + std::to_string(low) + " is above [" +
                     section + "] " + most + " = " + std::to_string(high));
  };
  check("walk_speed_min", p.walk_speed_min(), "walk_speed_max", p.walk_speed_max());
  check("walk_leg_min", p.walk_leg_min(), "walk_leg_max", p.walk_leg_max());
}

/// What [later] makes of a robot's parameters.
void check_later(const LaterSection& later, Parameters parameters) {
  const ParameterChanges changes = later.changes();
  if (later.at_s.has_value() && changes.values.empty())
    throw InputError("[later] at: no parameter is set then; expected a key of [later] beside it");
  for (const auto& [number, value] : changes.values) {
    if (!later.at_s.has_value()) {
      throw InputError(std::string("[later] ") + kParameterTable[number].name +
                       ": when is not said; expected at beside it");
    }
    parameters.values[number] = value;
  }
  check_parameters(parameters, "later");
}

/// What robots have of their own.
void check_robot_sections(const Experiment& experiment) {
  for (const auto& [place, value] : experiment.of_robots) {
    const auto [robot, key] = place;
    const std::string where = "[" + section_of_robot(robot) + "]";
    if (robot >= experiment.robots.count || experiment.robots.count == 1) {
      throw InputError(where + " " + experiment_keys()[key].name +
                       ": [robots] count = " + std::to_string(experiment.robots.count) +
                       "; sections of robots are for those of several, from [robot_0] on");
    }
    const Experiment own = experiment_of_robot(experiment, robot);
    if (own.experiment.algorithm == kTrainingDriveName) {
      throw InputError(where + " algorithm = " + kTrainingDriveName +
                       ": that records one robot, alone");
    }
    check_parameters(own.parameters, section_of_robot(robot));
    check_later(experiment.later, own.parameters);
  }
}

/// A note on each section with keys that were given for another kind of ground.
void note_idle_sections(Experiment& experiment) {
  std::set<std::string> noted;
  for (const ExperimentKey& key : experiment_keys()) {
    const auto place = experiment.places.find(full_name(key.section, key.name));
    if (place == experiment.places.end() || key.name == "wall_friction") continue;
    if (!decides_nothing(key, experiment.map) || !noted.insert(key.section).second) continue;
    const std::string what =
        key.section == "map" ? full_name(key.section, key.name) : "[" + key.section + "]";
    experiment.notes.push_back(place->second + ": " + what +
                               " decides nothing with [map] model = " + experiment.map.model);
  }
}

/// What no single key can tell.
void check(const Experiment& experiment) {
  check_robots(experiment);
  check_robot_sections(experiment);
  check_parameters(experiment.parameters, "parameters");
  check_later(experiment.later, experiment.parameters);
  if (!experiment.map.filename.empty() && experiment.map.ramp_deg != 0.0) {
    throw InputError("[map] filename = '" + experiment.map.filename +
                     "' and ramp are both given; a ramp needs no image");
  }
  if (experiment.map.ramp_deg != 0.0 && experiment.map.wrap()) {
    throw InputError(
        "[map] edges = wrap and ramp are both given; a slope does not repeat: allowed are edges = "
        "open or walls");
  }
  if (experiment.map.of_particles() && experiment.map.edge() == BedEdge::kOpen) {
    throw InputError("[map] edges = open: particles would roll off the bed; with model = " +
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
  const std::filesystem::path folder = data_folders().data / "experiments";
  std::array<std::vector<std::string>, 2> names;  // experiments, recipes of sessions
  for (const std::filesystem::path& entry : {folder, folder / "sessions"}) {
    for (const auto& file : std::filesystem::directory_iterator(entry)) {
      if (file.path().extension() != ".ini") continue;
      if (file.path().stem() == name) return file.path();
      names[entry == folder ? 0 : 1].push_back(file.path().stem().string());
    }
  }
  for (std::vector<std::string>& of_folder : names) std::sort(of_folder.begin(), of_folder.end());
  throw InputError(name.string() +
                   ": no such file, and no experiment of that name comes with Screed: " +
                   name_list(names[0]) + "; recipes of sessions: " + name_list(names[1]));
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

void apply_override(Experiment& experiment, const std::string& override) {
  apply(experiment, parse_override(override), "--set");
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
    apply(experiment, entry, source + ":" + std::to_string(entry.line), sandbox);
  // A pixel's width is a length; of particles the key is a share.
  if (sandbox && experiment.map.xy_scale.has_value() && !experiment.map.of_particles())
    *experiment.map.xy_scale /= kSandboxUnitsPerMetre;
  for (const PlacedEntry& placed : entries) apply(experiment, placed.entry, placed.where);
  experiment.parameters.algorithm() = algorithm_number(experiment.experiment.algorithm);
  experiment.source = whole;
  note_idle_sections(experiment);
  try {
    if (experiment.experiment.algorithm == kTrainingDriveName) set_training_length(experiment);
    if (experiment.experiment.frames.has_value())
      experiment.experiment.duration_s = *experiment.experiment.frames / double{kTickRate_hz};
    check(experiment);
  } catch (const InputError& error) {
    throw with_place(experiment, error);
  }
  return experiment;
}

std::string shipped_robots() {
  std::vector<std::string> names = {"rover5"};  // of its board
  for (const auto& entry : std::filesystem::directory_iterator(data_folders().data / "robots"))
    names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return name_list(names);
}

InputError with_place(const Experiment& experiment, const InputError& error) {
  constexpr const char* kNameCharacters = "abcdefghijklmnopqrstuvwxyz_0123456789";
  const std::string text = error.what();
  std::string where;
  for (size_t at = text.find('['); at != std::string::npos && where.empty();
       at = text.find('[', at + 1)) {
    const size_t key = text.find("] ", at);
    if (key == std::string::npos) break;
    const size_t end = text.find_first_not_of(kNameCharacters, key + 2);
    const auto place = experiment.places.find(text.substr(at, end - at));
    if (place != experiment.places.end()) where = place->second + ": ";
  }
  if (where.empty() && text.starts_with('[') && !experiment.source.empty())
    where = experiment.source + ": ";
  return text.starts_with(where) ? error : InputError(where + text);
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
  std::string text = std::string(key) + " = '" + name + "': no such file; looked for " + looked;
  if (kind == std::string_view("robots"))
    text += "; robots that come with Screed: " + shipped_robots();
  throw with_place(experiment, InputError(text));
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
