// An experiment: everything that decides a simulated run, as read from an INI file (thesis
// Figure 5.3 and our own sections).
//
// Reading is strict: an unknown section or key, a value out of range or of the wrong kind ends with
// one line that names file, line, key and what is allowed. docs/experiments.md lists every key; the
// list is made from the same table.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/parameters/parameters.h"
#include "host_sim/ground_station/station/command_key.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/run/experiment/board_table.h"

namespace screed {

/// [experiment] algorithm of the drive that training data is recorded on (thesis Algorithm 5).
inline constexpr const char* kTrainingDriveName = "training_drive";

struct Experiment {
  std::string output_directory_prefix = "out";

  struct {
    bool tracks = true;
    std::string track_model = "belt";  ///< or chain: links round the wheels
    int track_links = 0;               ///< of a chain, each side; 0: of about 10 mm
    double track_tension_n = 10.0;     ///< of a chain at rest
    std::string model = "board";       ///< a URDF file, rover5, or board: the board's own
    double x_m = 0.0;
    double y_m = 0.0;
    std::optional<double> z_m;
    double roll_deg = 0.0;
    double pitch_deg = 0.0;
    double heading_deg = 0.0;
    std::optional<double> leg_angle_deg;
    double track_friction = 0.8;
    double chassis_friction = 0.4;
  } vehicle;

  struct {
    std::string filename;  ///< a grey image; empty: level ground
    double size_m = 3.0;
    /// In place of size: metres a pixel of the image (rigid, scm).
    std::optional<double> xy_scale;
    double scale_m = 0.2;
    double smoothing_m = 0.0;
    std::optional<double> max_slope_deg;
    double ramp_deg = 0.0;  ///< without an image: level ground inclined towards east
    bool wrap = false;
    /// rigid, scm: deformable soil, particles, or static_particles: those that never move
    std::string model = "rigid";
    double particle_radius_m = 0.0125;

    bool of_particles() const { return model == "particles" || model == "static_particles"; }
  } map;

  /// What the particles of the models particles and static_particles are, and how many lie there.
  struct {
    double depth_m = 0.1;  ///< of the bed below the image's black
    double density_kg_per_m3 = 2600.0;
    double friction = 0.6;
    double rolling = 0.1;
  } particles;

  /// A place that the robot does not get out of, in front of its start (trap.h).
  struct {
    std::string kind = "none";
    double distance_m = 0.5;
    double size = 0.1;  ///< m; of a slope degrees
  } trap;

  struct {
    double resolution_per_m = 200.0;  ///< rays a metre that read the height map of particles
  } raygrid;

  /// Soil of the model scm: a named preset and what differs from it.
  struct {
    std::string preset = "viper";
    double cell_m = 0.005;
    bool bulldozing = true;
    bool avalanches = true;
    bool follow_slopes = true;
    SoilOverrides overrides;
  } soil;

  struct {
    std::string name = "experiment";
    std::string algorithm = "hill_sensing";
    double duration_s = 60.0;
    /// In place of duration, control ticks; the n of algorithm training_drive, for which it is
    /// always set.
    std::optional<uint32_t> frames;
    std::optional<double> stop_after_s;  ///< of the training drive
    uint64_t seed = 1;
    double flatness_deg = 5.0;  ///< epsilon of the thesis' flatness, as a slope
    std::optional<double> lay_on_side_at_s;
  } experiment;

  struct {
    double speed_m_per_s = 0.1;
    double yaw_rate_deg_per_s = 0.0;
  } drive;

  struct {
    bool noise = true;
    bool calibrated = true;
    bool handled = false;
  } sensors;

  struct {
    double delay_s = 0.012;
    double loss = 0.0;
    double bit_errors = 0.0;
    double duplication = 0.0;
    std::optional<double> range_m;
    double baud = 58823.5;
    double packet_pause = 3.0;
    bool ground_station = true;
    std::string key;                        ///< of robot and ground station; empty: the test key
    uint16_t boot_epoch = kFirstBootEpoch;  ///< number of the robot's start
  } radio;

  struct {
    double step_s = 0.001;
  } physics;

  Parameters parameters;

  /// What the reader of the file should be told: keys that were understood in another way than
  /// they look. Not part of text().
  std::vector<std::string> notes;

  /// Where the file stood: relative file names are looked for here first. Not part of text().
  std::filesystem::path folder = ".";

  /// All keys with the values in force, as an INI file that gives the same experiment again.
  std::string text() const;
};

/// Reads `path` and applies `overrides` ("section.key=value") on top. Throws InputError.
Experiment read_experiment(const std::filesystem::path& path,
                           const std::vector<std::string>& overrides = {});

/// The robot's key and number of its start; without a key when the experiment says so.
Credentials credentials_of(const Experiment& experiment);
/// What the ground station signs with: the robot's key, or the test key.
CommandKey ground_key_of(const Experiment& experiment);

/// The algorithm's number in the parameter table. Throws InputError for an unknown name.
int16_t algorithm_number(const std::string& name);

/// Finds a file named in an experiment: as given when absolute, else beside the experiment file,
/// else in the project's data folders. Throws InputError that lists where it looked.
std::filesystem::path find_data_file(const Experiment& experiment, const std::string& name,
                                     const char* key);
/// The URDF of [vehicle] model, on a robot with this board.
std::filesystem::path find_model_file(const Experiment& experiment,
                                      const std::string& board = kDefaultBoard);

/// One line a key: section.key, unit, default, allowed values, meaning; for docs and `screed sim
/// --keys`.
std::string experiment_key_table();

}  // namespace screed
