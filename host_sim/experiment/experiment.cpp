// Experiments: the table of keys and what is made of it.
#include "host_sim/experiment/experiment.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <system_error>

#include "firmware/leveling/leveling.h"
#include "firmware/robot/parameter_table.h"
#include "hal/sample.h"
#include "host_sim/core/errors.h"
#include "host_sim/experiment/ini_file.h"
#include "host_sim/experiment/trap.h"
#include "host_sim/soil/soil_parameters.h"
#include "paths.h"

namespace screed {
namespace {

constexpr const char* kNoKey = "none";

/// One key of an experiment file: how its value is read, written back and described.
struct Key {
  std::string section;
  std::string name;
  std::string unit;
  std::string allowed;  ///< for people
  std::string meaning;
  /// Returns false when the value is not allowed.
  std::function<bool(Experiment&, const std::string&)> set;
  /// The value in force; nothing when an optional key is not set.
  std::function<std::optional<std::string>(const Experiment&)> get;
};

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

template <class Number>
bool parse_number(const std::string& text, Number& value) {
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  return result.ec == std::errc() && result.ptr == end && !text.empty();
}

template <class Get>
Key real_key(const char* section, const char* name, const char* unit, double min, double max,
             const char* meaning, Get field) {
  const auto set = [=](Experiment& experiment, const std::string& text) {
    double value = 0.0;
    if (!parse_number(text, value) || !std::isfinite(value) || value < min || value > max)
      return false;
    field(experiment) = value;
    return true;
  };
  const auto get = [=](const Experiment& experiment) -> std::optional<std::string> {
    Experiment copy = experiment;
    const std::optional<double> value = field(copy);
    if (!value.has_value()) return std::nullopt;
    return shortest(*value);
  };
  return {section, name, unit, "a number " + shortest(min) + ".." + shortest(max),
          meaning, set,  get};
}

template <class Get>
Key bool_key(const char* section, const char* name, const char* meaning, Get field) {
  const auto set = [=](Experiment& experiment, const std::string& text) {
    if (text != "true" && text != "false") return false;
    field(experiment) = text == "true";
    return true;
  };
  const auto get = [=](const Experiment& experiment) -> std::optional<std::string> {
    Experiment copy = experiment;
    return field(copy) ? "true" : "false";
  };
  return {section, name, "", "true or false", meaning, set, get};
}

template <class Get>
Key text_key(const char* section, const char* name, const char* allowed, const char* meaning,
             Get field, bool (*accepts)(const std::string&)) {
  const auto set = [=](Experiment& experiment, const std::string& text) {
    if (!accepts(text)) return false;
    field(experiment) = text;
    return true;
  };
  const auto get = [=](const Experiment& experiment) -> std::optional<std::string> {
    Experiment copy = experiment;
    const std::string& value = field(copy);
    if (value.empty()) return std::nullopt;
    return value;
  };
  return {section, name, "", allowed, meaning, set, get};
}

/// A key that is not written back when another one holds in its place.
Key in_force_unless(Key key, bool (*replaced)(const Experiment&)) {
  key.get = [get = std::move(key.get), replaced](const Experiment& experiment) {
    return replaced(experiment) ? std::nullopt : get(experiment);
  };
  return key;
}

constexpr const char* kUnitsKey = "units";
constexpr const char* kSandboxKey = "chrono_data_path";
constexpr double kSandboxUnitsPerMetre = 12.0;
constexpr uint32_t kMostFrames = 8U * INT16_MAX;  // eight blocks of a parameter's range

bool is_units(const std::string& text) {
  return text == "si" || text == "sandbox";
}

struct AlgorithmName {
  const char* name;
  LevelingAlgorithm algorithm;
};
constexpr AlgorithmName kAlgorithms[] = {
    {"drive", LevelingAlgorithm::kDrive},
    {"hill_sensing", LevelingAlgorithm::kHillSensing},
    {"random", LevelingAlgorithm::kTraining},
    {"spin_on_peak", LevelingAlgorithm::kSpinOnPeak},
};

bool is_algorithm(const std::string& name) {
  return std::any_of(std::begin(kAlgorithms), std::end(kAlgorithms),
                     [&](const AlgorithmName& known) { return name == known.name; });
}

bool is_file_name(const std::string& text) {
  return !text.empty() && text.size() <= 64 &&
         text.find_first_not_of(
             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") ==
             std::string::npos;
}

bool is_soil(const std::string& name) {
  return std::any_of(soil_presets().begin(), soil_presets().end(),
                     [&](const SoilParameters& known) { return known.name == name; });
}

bool is_ground(const std::string& name) {
  return name == "rigid" || name == "scm" || name == "particles" || name == "static_particles";
}

bool is_key(const std::string& text) {
  if (text == kNoKey) return true;
  try {
    parse_key(text, "");
    return true;
  } catch (const InputError&) {
    return false;
  }
}

bool not_empty(const std::string& text) {
  return !text.empty();
}

std::vector<Key> make_keys() {
  std::vector<Key> keys;
  keys.push_back(text_key(
      "", "output_directory_prefix", "a folder", "where run folders are made",
      [](Experiment& e) -> std::string& { return e.output_directory_prefix; }, not_empty));
  const auto not_kept = [](const Experiment&) -> std::optional<std::string> { return {}; };
  keys.push_back({"", kUnitsKey, "", "si or sandbox",
                  "sandbox: a file of the thesis' simulator, see below",
                  [](Experiment&, const std::string& text) { return is_units(text); }, not_kept});
  keys.push_back({"", kSandboxKey, "", "a folder", "not used; marks a file of units = sandbox",
                  [](Experiment&, const std::string& text) { return !text.empty(); }, not_kept});

  keys.push_back(bool_key("vehicle", "tracks", "tracks round the wheels; false: four driven wheels",
                          [](Experiment& e) -> bool& { return e.vehicle.tracks; }));
  keys.push_back(text_key(
      "vehicle", "track_model", "belt or chain", "what a track is; chain: links round its wheels",
      [](Experiment& e) -> std::string& { return e.vehicle.track_model; },
      [](const std::string& text) { return text == "belt" || text == "chain"; }));
  keys.push_back({"vehicle", "track_links", "", "an integer 0..400",
                  "track_model chain: links of each side; 0: as many as are about 10 mm long",
                  [](Experiment& e, const std::string& text) {
                    int links = 0;
                    if (!parse_number(text, links) || links < 0 || links > 400) return false;
                    e.vehicle.track_links = links;
                    return true;
                  },
                  [](const Experiment& e) -> std::optional<std::string> {
                    return std::to_string(e.vehicle.track_links);
                  }});
  keys.push_back(real_key("vehicle", "track_tension", "N", 1, 50,
                          "track_model chain: tension of the chain at rest",
                          [](Experiment& e) -> double& { return e.vehicle.track_tension_n; }));
  keys.push_back(text_key(
      "vehicle", "model", "a URDF file, rover5 or board",
      "the robot; board: the one the board is built into",
      [](Experiment& e) -> std::string& { return e.vehicle.model; }, not_empty));
  keys.push_back(real_key("vehicle", "x", "m", -500, 500, "start position, east",
                          [](Experiment& e) -> double& { return e.vehicle.x_m; }));
  keys.push_back(real_key("vehicle", "y", "m", -500, 500, "start position, north",
                          [](Experiment& e) -> double& { return e.vehicle.y_m; }));
  keys.push_back(real_key("vehicle", "z", "m", -200, 200,
                          "start height of the chassis; left out: set down on the ground",
                          [](Experiment& e) -> std::optional<double>& { return e.vehicle.z_m; }));
  keys.push_back(real_key("vehicle", "r", "deg", -180, 180, "start roll, left side up",
                          [](Experiment& e) -> double& { return e.vehicle.roll_deg; }));
  keys.push_back(real_key("vehicle", "p", "deg", -90, 90, "start pitch, nose up",
                          [](Experiment& e) -> double& { return e.vehicle.pitch_deg; }));
  keys.push_back(real_key("vehicle", "h", "deg", -360, 360,
                          "start heading, counter-clockwise from east",
                          [](Experiment& e) -> double& { return e.vehicle.heading_deg; }));
  keys.push_back(
      real_key("vehicle", "leg_angle", "deg", -90, 90,
               "angle of the legs below the horizontal; left out: as in the model",
               [](Experiment& e) -> std::optional<double>& { return e.vehicle.leg_angle_deg; }));
  keys.push_back(real_key("vehicle", "track_friction", "", 0.01, 5,
                          "Coulomb friction between track or wheel and ground",
                          [](Experiment& e) -> double& { return e.vehicle.track_friction; }));
  keys.push_back(real_key("vehicle", "chassis_friction", "", 0.0, 5,
                          "Coulomb friction between chassis and ground",
                          [](Experiment& e) -> double& { return e.vehicle.chassis_friction; }));

  keys.push_back(text_key(
      "map", "filename", "a grey PNG or BMP file", "height map; left out: level ground, or a ramp",
      [](Experiment& e) -> std::string& { return e.map.filename; }, not_empty));
  // Of two keys that stand for the same the later one holds; only that one is written back.
  Key size = real_key("map", "size", "m", 0.1, 1000, "length of the bed's longer side",
                      [](Experiment& e) -> double& {
                        e.map.xy_scale.reset();
                        return e.map.size_m;
                      });
  keys.push_back(
      in_force_unless(size, [](const Experiment& e) { return e.map.xy_scale.has_value(); }));
  keys.push_back(
      real_key("map", "xy_scale", "m", 1e-5, 100,
               "in place of size: width of a pixel; of particles: stacks a pixel, without unit",
               [](Experiment& e) -> std::optional<double>& { return e.map.xy_scale; }));
  keys.push_back(real_key("map", "scale", "m", 0.0001, 100, "height of white",
                          [](Experiment& e) -> double& { return e.map.scale_m; }));
  keys.push_back(real_key("map", "smoothing", "m", 0, 1,
                          "standard deviation of a Gaussian low-pass over the image",
                          [](Experiment& e) -> double& { return e.map.smoothing_m; }));
  keys.push_back(real_key(
      "map", "max_slope", "deg", 0.1, 89, "heights are scaled down until no slope is steeper",
      [](Experiment& e) -> std::optional<double>& { return e.map.max_slope_deg; }));
  keys.push_back(real_key("map", "ramp", "deg", -60, 60,
                          "without a file: slope of the ground, rising to the east",
                          [](Experiment& e) -> double& { return e.map.ramp_deg; }));
  keys.push_back(bool_key("map", "wrap",
                          "the terrain repeats at its edges; the image must be tileable",
                          [](Experiment& e) -> bool& { return e.map.wrap; }));
  keys.push_back(text_key(
      "map", "model", "rigid, scm, particles or static_particles",
      "how the ground answers; scm: soil that gives way, see [soil]; particles: a bed of spheres",
      [](Experiment& e) -> std::string& { return e.map.model; }, is_ground));
  keys.push_back(real_key("map", "particle_radius", "m", 0.001, 0.5,
                          "model particles: of every particle",
                          [](Experiment& e) -> double& { return e.map.particle_radius_m; }));

  keys.push_back(real_key("particles", "depth", "m", 0, 10,
                          "of the bed below the image's black; of level ground",
                          [](Experiment& e) -> double& { return e.particles.depth_m; }));
  keys.push_back(real_key("particles", "density", "kg/m^3", 10, 20000, "of a particle",
                          [](Experiment& e) -> double& { return e.particles.density_kg_per_m3; }));
  keys.push_back(real_key("particles", "friction", "", 0, 5,
                          "Coulomb friction between particles, and on the walls",
                          [](Experiment& e) -> double& { return e.particles.friction; }));
  keys.push_back(real_key("particles", "rolling", "", 0, 5,
                          "resistance to rolling, as a share of the radius",
                          [](Experiment& e) -> double& { return e.particles.rolling; }));

  keys.push_back(real_key("raygrid", "resolution", "1/m", 2, 2000,
                          "model particles: rays a metre that read the height map",
                          [](Experiment& e) -> double& { return e.raygrid.resolution_per_m; }));

  keys.push_back(text_key(
      "soil", "preset", "soft, viper, lete_sand, dry_sand, clay, ding_2011 or gravel",
      "model scm: a named soil", [](Experiment& e) -> std::string& { return e.soil.preset; },
      is_soil));
  keys.push_back(real_key("soil", "cell", "m", 0.001, 0.05, "model scm: side of a grid cell",
                          [](Experiment& e) -> double& { return e.soil.cell_m; }));
  keys.push_back(bool_key("soil", "bulldozing", "sunk material is pushed aside; false: compacted",
                          [](Experiment& e) -> bool& { return e.soil.bulldozing; }));
  keys.push_back(bool_key("soil", "avalanches", "slopes above the angle of repose slide",
                          [](Experiment& e) -> bool& { return e.soil.avalanches; }));
  keys.push_back(bool_key("soil", "follow_slopes",
                          "ruts uphill and downhill are as deep as on the level; false: too deep "
                          "below belts going downhill",
                          [](Experiment& e) -> bool& { return e.soil.follow_slopes; }));
  using Optional = std::optional<double>;
  keys.push_back(real_key("soil", "k_phi", "N/m^(n+2)", 0, 1e12,
                          "Bekker's frictional modulus; left out: the preset's",
                          [](Experiment& e) -> Optional& { return e.soil.k_phi; }));
  keys.push_back(real_key("soil", "k_c", "N/m^(n+1)", 0, 1e12, "Bekker's cohesive modulus",
                          [](Experiment& e) -> Optional& { return e.soil.k_c; }));
  keys.push_back(real_key("soil", "n", "", 0.1, 2.5, "Bekker's exponent of sinkage",
                          [](Experiment& e) -> Optional& { return e.soil.exponent; }));
  keys.push_back(real_key("soil", "c", "Pa", 0, 1e7, "cohesion",
                          [](Experiment& e) -> Optional& { return e.soil.cohesion_pa; }));
  keys.push_back(real_key("soil", "phi", "deg", 0, 60, "angle of internal friction",
                          [](Experiment& e) -> Optional& { return e.soil.friction_deg; }));
  keys.push_back(real_key("soil", "K", "m", 1e-5, 1, "Janosi-Hanamoto shear modulus",
                          [](Experiment& e) -> Optional& { return e.soil.shear_modulus_m; }));
  keys.push_back(real_key("soil", "E", "Pa/m", 1e4, 1e12, "stiffness of unloading",
                          [](Experiment& e) -> Optional& { return e.soil.elastic_pa_per_m; }));
  keys.push_back(real_key("soil", "R", "Pa s/m", 0, 1e9, "damping of sinking",
                          [](Experiment& e) -> Optional& { return e.soil.damping_pa_s_per_m; }));
  keys.push_back(real_key("soil", "repose", "deg", 1, 60, "angle of repose",
                          [](Experiment& e) -> Optional& { return e.soil.repose_deg; }));
  keys.push_back(real_key("soil", "compaction", "", 0, 1,
                          "share of the sunk volume that is compacted",
                          [](Experiment& e) -> Optional& { return e.soil.compaction; }));
  keys.push_back(real_key("soil", "drag_depth", "m", 0, 1,
                          "thickness of the layer that a slipping surface digs away",
                          [](Experiment& e) -> Optional& { return e.soil.drag_depth_m; }));
  keys.push_back(real_key("soil", "slip_sinkage", "", 0, 2, "growth of n with slip",
                          [](Experiment& e) -> Optional& { return e.soil.slip_sinkage; }));

  keys.push_back(text_key(
      "experiment", "name", "letters, digits, _ and -; at most 64", "names the run folder",
      [](Experiment& e) -> std::string& { return e.experiment.name; }, is_file_name));
  keys.push_back(text_key(
      "experiment", "algorithm", "drive, hill_sensing, random or spin_on_peak",
      "what the firmware does; random: Algorithm 5, the drive for training data",
      [](Experiment& e) -> std::string& { return e.experiment.algorithm; }, is_algorithm));
  Key duration = real_key("experiment", "duration", "s", 0.01, 1e6, "simulated time",
                          [](Experiment& e) -> double& {
                            e.experiment.frames.reset();
                            return e.experiment.duration_s;
                          });
  keys.push_back(in_force_unless(
      duration, [](const Experiment& e) { return e.experiment.frames.has_value(); }));
  keys.push_back(
      {"experiment", "frames", "0.01 s", "a multiple of 8, 8.." + std::to_string(kMostFrames),
       "in place of duration; algorithm random: the n of Algorithm 5",
       [](Experiment& e, const std::string& text) {
         uint32_t frames = 0;
         if (!parse_number(text, frames) || frames < 8 || frames > kMostFrames || frames % 8 != 0)
           return false;
         e.experiment.frames = frames;
         return true;
       },
       [](const Experiment& e) -> std::optional<std::string> {
         if (!e.experiment.frames.has_value()) return std::nullopt;
         return std::to_string(*e.experiment.frames);
       }});
  keys.push_back(
      {"experiment", "seed", "", "an integer 0..18446744073709551615",
       "of every random generator of the world",
       [](Experiment& e, const std::string& text) { return parse_number(text, e.experiment.seed); },
       [](const Experiment& e) -> std::optional<std::string> {
         return std::to_string(e.experiment.seed);
       }});
  keys.push_back(real_key("experiment", "flatness", "deg", 0.0, 89,
                          "slope up to which ground counts as flat",
                          [](Experiment& e) -> double& { return e.experiment.flatness_deg; }));
  keys.push_back(real_key(
      "experiment", "lay_on_side_at", "s", 0.01, 1e6,
      "fault: the robot is laid on its side at this time",
      [](Experiment& e) -> std::optional<double>& { return e.experiment.lay_on_side_at_s; }));

  keys.push_back(text_key(
      "trap", "kind", "none, wall, slope, trench, hump or ruts",
      "a place where robots get stuck: a wall, a slope or a trench all round the start; a hump "
      "between the tracks, ruts under them, in front of it",
      [](Experiment& e) -> std::string& { return e.trap.kind; }, is_trap));
  const auto no_trap = [](const Experiment& e) { return e.trap.kind == "none"; };
  keys.push_back(in_force_unless(
      real_key("trap", "distance", "m", -10, 10,
               "from the start to where it begins, 0.5 if left out; ruts may begin behind it",
               [](Experiment& e) -> double& { return e.trap.distance_m; }),
      no_trap));
  keys.push_back(in_force_unless(
      real_key("trap", "size", "m or deg", 0.001, 60,
               "height or depth in m, 0.1 if left out; of a slope its angle in degrees",
               [](Experiment& e) -> double& { return e.trap.size; }),
      no_trap));

  keys.push_back(real_key("drive", "speed", "m/s", -0.5, 0.5, "algorithm drive: commanded speed",
                          [](Experiment& e) -> double& { return e.drive.speed_m_per_s; }));
  keys.push_back(real_key("drive", "yaw_rate", "deg/s", -179, 179,
                          "algorithm drive: commanded turn rate",
                          [](Experiment& e) -> double& { return e.drive.yaw_rate_deg_per_s; }));

  keys.push_back(
      bool_key("sensors", "noise",
               "noise, bias and scale errors as in the data sheets; false: quantisation alone",
               [](Experiment& e) -> bool& { return e.sensors.noise; }));
  keys.push_back(
      bool_key("sensors", "calibrated",
               "what a calibration leaves of the chips' biases; false: as the chips come",
               [](Experiment& e) -> bool& { return e.sensors.calibrated; }));
  keys.push_back(bool_key(
      "sensors", "handled",
      "the IMU feels a person turning the robot over, as screed calibrate asks; the robot stands",
      [](Experiment& e) -> bool& { return e.sensors.handled; }));

  keys.push_back(real_key("radio", "delay", "s", 0, 10,
                          "of a packet, from its end in one module to its way out of the other",
                          [](Experiment& e) -> double& { return e.radio.delay_s; }));
  keys.push_back(real_key("radio", "loss", "", 0, 1, "probability that a packet is lost",
                          [](Experiment& e) -> double& { return e.radio.loss; }));
  keys.push_back(real_key("radio", "bit_errors", "", 0, 1,
                          "probability that a bit of an arriving byte is wrong",
                          [](Experiment& e) -> double& { return e.radio.bit_errors; }));
  keys.push_back(real_key("radio", "duplication", "", 0, 1,
                          "probability that an arriving packet comes twice",
                          [](Experiment& e) -> double& { return e.radio.duplication; }));
  keys.push_back(real_key("radio", "range", "m", 0.1, 100000,
                          "distance at which half of the full packets are lost; left out: none is "
                          "too far",
                          [](Experiment& e) -> std::optional<double>& { return e.radio.range_m; }));
  keys.push_back(real_key("radio", "baud", "baud", 1200, 1e6,
                          "of the serial lines at the modules, 10 bits a byte",
                          [](Experiment& e) -> double& { return e.radio.baud; }));
  keys.push_back(real_key("radio", "packet_pause", "characters", 1, 255,
                          "silence that ends a packet (the XBee's parameter RO)",
                          [](Experiment& e) -> double& { return e.radio.packet_pause; }));
  keys.push_back(bool_key("radio", "ground_station", "the ground station arms and starts the robot",
                          [](Experiment& e) -> bool& { return e.radio.ground_station; }));

  keys.push_back(text_key(
      "radio", "key",
      "32 hexadecimal digits, then a blank and the robot's id if it is not 1; or none",
      "of robot and ground station; left out: the test key 00 01 .. 0F; none: the robot has no key",
      [](Experiment& e) -> std::string& { return e.radio.key; }, is_key));
  keys.push_back({"radio", "boot_epoch", "", "an integer 2..65535",
                  "number of the robot's start, part of every command's freshness",
                  [](Experiment& e, const std::string& text) {
                    return parse_number(text, e.radio.boot_epoch) &&
                           e.radio.boot_epoch >= kFirstBootEpoch;
                  },
                  [](const Experiment& e) -> std::optional<std::string> {
                    return std::to_string(e.radio.boot_epoch);
                  }});

  keys.push_back(real_key("physics", "step", "s", 1e-5, 0.01, "of the integration; divides 0.01 s",
                          [](Experiment& e) -> double& { return e.physics.step_s; }));

  for (const ParameterInfo& info : kParameterTable) {
    // Said in [experiment]: algorithm by its name, and frames.
    if (info.field == &Parameters::algorithm || info.field == &Parameters::training_block) continue;
    keys.push_back({"parameters", info.name, info.unit,
                    "an integer " + std::to_string(info.min) + ".." + std::to_string(info.max),
                    info.meaning,
                    [info](Experiment& e, const std::string& text) {
                      int16_t value = 0;
                      if (!parse_number(text, value) || value < info.min || value > info.max)
                        return false;
                      e.parameters.*info.field = value;
                      return true;
                    },
                    [info](const Experiment& e) -> std::optional<std::string> {
                      return std::to_string(e.parameters.*info.field);
                    }});
  }
  return keys;
}

const std::vector<Key>& keys() {
  static const std::vector<Key> table = make_keys();
  return table;
}

/// Keys of a kind of ground that the experiment does not have.
bool decides_nothing(const Key& key, const std::string& model, bool of_particles) {
  if (key.section == "soil") return model != "scm";
  return !of_particles &&
         (key.section == "particles" || key.section == "raygrid" || key.name == "particle_radius");
}

std::string full_name(const std::string& section, const std::string& key) {
  return section.empty() ? key : "[" + section + "] " + key;
}

/// The known names most like what was written, to say what is allowed.
std::string known_names(const std::string& section) {
  std::string names;
  for (const Key& key : keys()) {
    if (key.section == section) names += (names.empty() ? "" : ", ") + key.name;
  }
  return names;
}

std::string known_sections() {
  std::string names;
  std::string last;
  for (const Key& key : keys()) {
    if (key.section != last && !key.section.empty())
      names += (names.empty() ? "[" : ", [") + key.section + "]";
    last = key.section;
  }
  return names;
}

void apply(Experiment& experiment, const IniEntry& entry, const std::string& source) {
  const std::string where = entry.line > 0 ? source + ":" + std::to_string(entry.line) : "--set";
  const auto key = std::find_if(keys().begin(), keys().end(), [&](const Key& known) {
    return known.section == entry.section && known.name == entry.key;
  });
  if (key == keys().end()) {
    const std::string names = known_names(entry.section);
    if (names.empty()) {
      throw InputError(where + ": unknown section [" + entry.section + "]; known are " +
                       known_sections());
    }
    throw InputError(
        where + ": unknown key '" + entry.key + "'" +
        (entry.section.empty() ? " before the first section" : " in [" + entry.section + "]") +
        "; known are " + names);
  }
  if (!key->set(experiment, entry.value)) {
    throw InputError(where + ": " + full_name(entry.section, entry.key) + " = '" + entry.value +
                     "' is not allowed; expected " + key->allowed +
                     (key->unit.empty() ? "" : " (" + key->unit + ")"));
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
    if (wanted < 8.0 || wanted > kMostFrames) {
      throw InputError(source +
                       ": [experiment] duration = " + shortest(experiment.experiment.duration_s) +
                       " s: algorithm random needs 0.08 s to " +
                       shortest(kMostFrames / double{kTickRate_hz}) + " s");
    }
    frames = static_cast<uint32_t>(wanted);
  }
  experiment.parameters.training_block = static_cast<int16_t>(*frames / 8);
}

/// What no single key can tell.
void check(const Experiment& experiment, const std::string& source) {
  const Parameters& p = experiment.parameters;
  if (p.walk_speed_min > p.walk_speed_max) {
    throw InputError(source +
                     ": [parameters] walk_speed_min = " + std::to_string(p.walk_speed_min) +
                     " is above walk_speed_max = " + std::to_string(p.walk_speed_max));
  }
  if (p.walk_leg_min > p.walk_leg_max) {
    throw InputError(source + ": [parameters] walk_leg_min = " + std::to_string(p.walk_leg_min) +
                     " is above walk_leg_max = " + std::to_string(p.walk_leg_max));
  }
  if (!experiment.map.filename.empty() && experiment.map.ramp_deg != 0.0) {
    throw InputError(source + ": [map] has both filename and ramp; a ramp needs no image");
  }
}

}  // namespace

CommandKey ground_key_of(const Experiment& experiment) {
  const std::string& key = experiment.radio.key;
  return key.empty() || key == kNoKey ? test_key() : parse_key(key, "[radio] key");
}

Credentials credentials_of(const Experiment& experiment) {
  Credentials credentials = credentials_of(ground_key_of(experiment), experiment.radio.boot_epoch);
  credentials.key_set = experiment.radio.key != kNoKey;
  return credentials;
}

int16_t algorithm_number(const std::string& name) {
  for (const AlgorithmName& known : kAlgorithms) {
    if (name == known.name) return static_cast<int16_t>(known.algorithm);
  }
  throw InputError("unknown algorithm '" + name + "'");
}

std::string Experiment::text() const {
  std::string text;
  std::string section;
  for (const Key& key : keys()) {
    const std::optional<std::string> value = key.get(*this);
    if (!value.has_value()) continue;
    if (decides_nothing(key, map.model, map.of_particles())) continue;
    if (key.section != section) text += "\n[" + key.section + "]\n";
    section = key.section;
    text += key.name + " = " + *value + "\n";
  }
  return text;
}

Experiment read_experiment(const std::filesystem::path& path,
                           const std::vector<std::string>& overrides) {
  Experiment experiment;
  experiment.folder = path.parent_path().empty() ? std::filesystem::path(".") : path.parent_path();
  const std::string source = path.string();
  const std::vector<IniEntry> entries = read_ini_file(path);
  const bool sandbox = is_sandbox(entries, source, experiment);
  // Its terrains have no edges: who leaves on one side comes back on the other (thesis 5.1.4).
  experiment.map.wrap = sandbox;
  if (sandbox) experiment.particles.depth_m = 0.0;
  for (const IniEntry& entry : entries)
    apply(experiment, sandbox ? from_sandbox(entry) : entry, source);
  // A pixel's width is a length; of particles the key is a share.
  if (sandbox && experiment.map.xy_scale.has_value() && !experiment.map.of_particles())
    *experiment.map.xy_scale /= kSandboxUnitsPerMetre;
  for (const std::string& text : overrides) apply(experiment, parse_override(text), source);
  experiment.parameters.algorithm = algorithm_number(experiment.experiment.algorithm);
  if (experiment.experiment.algorithm == "random") set_training_length(experiment, source);
  if (experiment.experiment.frames.has_value())
    experiment.experiment.duration_s = *experiment.experiment.frames / double{kTickRate_hz};
  check(experiment, source);
  return experiment;
}

std::filesystem::path find_data_file(const Experiment& experiment, const std::string& name,
                                     const char* key) {
  const std::filesystem::path file(name);
  std::vector<std::filesystem::path> places;
  if (file.is_absolute()) {
    places = {file};
  } else {
    places = {experiment.folder / file, std::filesystem::path(kDataFolder) / "terrain" / file};
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
    return std::filesystem::path(kBoardsFolder) / "a_star_32u4" / "rover5.urdf";
  }
  return find_data_file(experiment, experiment.vehicle.model, "[vehicle] model");
}

std::string experiment_key_table() {
  const Experiment defaults;
  std::string text;
  for (const Key& key : keys()) {
    const std::optional<std::string> value = key.get(defaults);
    text += "| " + (key.section.empty() ? "" : "[" + key.section + "] ") + key.name + " | " +
            key.unit + " | " + value.value_or("") + " | " + key.allowed + " | " + key.meaning +
            " |\n";
  }
  return text;
}

}  // namespace screed
