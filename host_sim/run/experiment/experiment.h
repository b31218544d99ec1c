// An experiment: everything that decides a simulated run, as read from an INI file (thesis
// Figure 5.3 and our own sections).
//
// Reading is strict: an unknown section or key, a value out of range or of the wrong kind ends with
// one line that names file, line, key and what is allowed. `screed sim --keys` lists every key,
// from the same table.
//
// A section is a struct in a file beside this one: its fields, and below them its keys. A new key
// is a field and a row there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/ground_station/station/command_key.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/ground_sections.h"
#include "host_sim/run/experiment/vehicle_sections.h"

namespace screed {

/// [experiment] algorithm of the drive that training data is recorded on (thesis Algorithm 5).
inline constexpr const char* kTrainingDriveName = "training_drive";

/// A robot's number, and the number in experiment_keys() of a key that it has otherwise.
using KeyOfRobot = std::pair<size_t, size_t>;

struct Experiment {
  std::string output_directory_prefix = "out";

  VehicleSection vehicle;
  RobotsSection robots;
  MapSection map;
  ReliefSection relief;
  ParticlesSection particles;
  TrapSection trap;
  RaygridSection raygrid;
  SoilSection soil;
  ExperimentSection experiment;
  DriveSection drive;
  FixesSection fixes;
  LaterSection later;
  BatterySection battery;
  SensorsSection sensors;
  RadioSection radio;
  PhysicsSection physics;
  MetricsSection metrics;
  Parameters parameters;
  /// The sections [robot_0] and so on: values by robot and key (robot_sections.h).
  std::map<KeyOfRobot, std::string> of_robots;

  /// Notes for the user of the file: keys that were understood in another way than
  /// they look. Not part of text().
  std::vector<std::string> notes;

  /// Where each key was given that was, by its full name: "[map] size", "e.ini:4". And what
  /// messages call the whole. Not part of text().
  std::map<std::string, std::string> places;
  std::string source;

  /// Where the file stood: relative file names are looked for here first. Not part of text().
  std::filesystem::path folder = ".";

  /// All keys with the values in force, as an INI file that gives the same experiment again.
  std::string text() const;
};

/// The file of an experiment that a user names: "first_drive" is the one that comes with the
/// program, unless a file is called that; a name with a folder or an extension is returned as it
/// is. Throws InputError.
std::filesystem::path find_experiment(const std::filesystem::path& name);

/// Reads `path` (see find_experiment) and applies `overrides` ("section.key=value") on top. Throws
/// InputError.
Experiment read_experiment(const std::filesystem::path& path,
                           const std::vector<std::string>& overrides = {});

/// Puts one override on top of an experiment. What no single key can tell is not checked. Throws
/// InputError.
void apply_override(Experiment& experiment, const std::string& override);

/// The entries of an experiment file, for experiments that have it in common.
struct ExperimentFile {
  std::filesystem::path path;  ///< as messages call it; data files are looked for beside it first
  std::vector<IniEntry> entries;
};
/// Reads `name` (see find_experiment). Throws InputError.
ExperimentFile read_experiment_file(const std::filesystem::path& name);

/// An entry that is put on top of a file, in SI units whatever the file's are.
struct PlacedEntry {
  IniEntry entry;
  std::string where;  ///< its place, as messages call it
};
/// The experiment of a file with these entries on top, the last one of a key in force. Messages
/// about several keys begin with `whole`. Throws InputError.
Experiment make_experiment(const ExperimentFile& file, const std::vector<PlacedEntry>& entries,
                           const std::string& whole);

/// An error that names keys as "[map] size", with the place where the first of them was given; of
/// keys that nobody gave, with that of the whole experiment.
InputError with_place(const Experiment& experiment, const InputError& error);

/// The robot's key and number of its start; without a key when the experiment says so.
Credentials credentials_of(const Experiment& experiment);
/// What the ground station signs with: the robot's key, or the test key.
CommandKey ground_key_of(const Experiment& experiment);

/// The algorithm's number in the parameter table. Throws InputError for an unknown name.
int16_t algorithm_number(const std::string& name);

/// "four_wheels, rover5": for messages.
std::string shipped_robots();

/// Finds a file named in an experiment: as given when absolute, else beside the experiment file,
/// else in the folder `kind` of the project's data. Throws InputError that lists where it looked.
std::filesystem::path find_data_file(const Experiment& experiment, const std::string& name,
                                     const char* key, const char* kind = "terrain");
/// The URDF of [vehicle] model, on a robot with this board; a name without extension is one of the
/// project's robots.
std::filesystem::path find_model_file(const Experiment& experiment,
                                      const std::string& board = kDefaultBoard);

/// One line a key: section.key, unit, default, allowed values, meaning; for docs and `screed sim
/// --keys`.
std::string experiment_key_table();

}  // namespace screed
