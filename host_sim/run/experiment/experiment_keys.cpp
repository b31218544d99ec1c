// The table of keys.
#include "host_sim/run/experiment/experiment_keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "firmware/parameters/parameter_table.h"
#include "host_sim/core/errors.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/run/experiment/trap.h"

namespace screed {
namespace {

template <class Get>
ExperimentKey real_key(const char* section, const char* name, const char* unit, double min,
                       double max, const char* meaning, Get field) {
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
ExperimentKey bool_key(const char* section, const char* name, const char* meaning, Get field) {
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
ExperimentKey text_key(const char* section, const char* name, const std::string& allowed,
                       const char* meaning, Get field, bool (*accepts)(const std::string&)) {
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
ExperimentKey in_force_unless(ExperimentKey key, bool (*replaced)(const Experiment&)) {
  key.get = [get = std::move(key.get), replaced](const Experiment& experiment) {
    return replaced(experiment) ? std::nullopt : get(experiment);
  };
  return key;
}

bool is_units(const std::string& text) {
  return text == "si" || text == "sandbox";
}

/// The leveling algorithms of the schema: numbers and names.
std::span<const ValueInfo> algorithms() {
  return find_signal("leveling.algorithm").signal->values;
}

bool is_algorithm(const std::string& name) {
  return std::any_of(algorithms().begin(), algorithms().end(),
                     [&](const ValueInfo& known) { return name == known.name; });
}

/// "a, b or c".
std::string algorithm_list() {
  std::string text;
  const std::vector<std::string> names = value_names("leveling.algorithm");
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 < names.size() ? ", " : " or ";
    text += names[i];
  }
  return text;
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

bool is_terrain_model(const std::string& name) {
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

std::vector<ExperimentKey> make_keys() {
  std::vector<ExperimentKey> keys;
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
  ExperimentKey size = real_key("map", "size", "m", 0.1, 1000, "length of the bed's longer side",
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
      "terrain model; scm: deformable soil, see [soil]; particles: a bed of spheres",
      [](Experiment& e) -> std::string& { return e.map.model; }, is_terrain_model));
  keys.push_back(real_key("map", "particle_radius", "m", 0.001, 0.5,
                          "model particles: radius of a particle",
                          [](Experiment& e) -> double& { return e.map.particle_radius_m; }));

  keys.push_back(real_key("particles", "depth", "m", 0, 10,
                          "depth of the bed below the image's black; on level ground its depth",
                          [](Experiment& e) -> double& { return e.particles.depth_m; }));
  keys.push_back(real_key("particles", "density", "kg/m^3", 10, 20000, "density of a particle",
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
  keys.push_back(real_key("soil", "shear_damping", "s", 0, 0.1,
                          "damping of small shear, over its stiffness; 0.002 by default",
                          [](Experiment& e) -> Optional& { return e.soil.shear_damping_s; }));
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
      "experiment", "algorithm", algorithm_list(),
      "what the firmware does; training_drive: the drive for training data (thesis Algorithm 5)",
      [](Experiment& e) -> std::string& { return e.experiment.algorithm; }, is_algorithm));
  ExperimentKey duration = real_key("experiment", "duration", "s", 0.01, 1e6, "simulated time",
                                    [](Experiment& e) -> double& {
                                      e.experiment.frames.reset();
                                      return e.experiment.duration_s;
                                    });
  keys.push_back(in_force_unless(
      duration, [](const Experiment& e) { return e.experiment.frames.has_value(); }));
  keys.push_back(
      {"experiment", "frames", "0.01 s", "a multiple of 8, 8.." + std::to_string(kMaxFrames),
       "in place of duration; algorithm training_drive: the n of Algorithm 5",
       [](Experiment& e, const std::string& text) {
         uint32_t frames = 0;
         if (!parse_number(text, frames) || frames < 8 || frames > kMaxFrames || frames % 8 != 0)
           return false;
         e.experiment.frames = frames;
         return true;
       },
       [](const Experiment& e) -> std::optional<std::string> {
         if (!e.experiment.frames.has_value()) return std::nullopt;
         return std::to_string(*e.experiment.frames);
       }});
  keys.push_back(real_key(
      "experiment", "stop_after", "s", 0.01, 1e4,
      "algorithm training_drive: the run ends when the drive has lasted so long, whatever its n",
      [](Experiment& e) -> std::optional<double>& { return e.experiment.stop_after_s; }));
  keys.push_back(
      {"experiment", "seed", "", "an integer 0..18446744073709551615",
       "seed of every random generator of the world",
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
      "obstacle that robots get stuck at: a wall, a slope or a trench all round the start; a hump "
      "between the tracks, ruts under them, in front of it",
      [](Experiment& e) -> std::string& { return e.trap.kind; }, is_trap));
  const auto no_trap = [](const Experiment& e) { return e.trap.kind == "none"; };
  keys.push_back(
      in_force_unless(real_key("trap", "distance", "m", -10, 10,
                               "distance from the start to the obstacle, 0.5 if left out; ruts may "
                               "begin behind the start",
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

  keys.push_back(
      real_key("radio", "delay", "s", 0, 10,
               "latency of a packet, from its end in one module to its first byte out of the other",
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
                          "baud rate of the serial lines at the modules, 10 bits a byte",
                          [](Experiment& e) -> double& { return e.radio.baud; }));
  keys.push_back(real_key("radio", "packet_pause", "characters", 1, 255,
                          "silence that ends a packet (the XBee's parameter RO)",
                          [](Experiment& e) -> double& { return e.radio.packet_pause; }));
  keys.push_back(bool_key("radio", "ground_station", "the ground station arms and starts the robot",
                          [](Experiment& e) -> bool& { return e.radio.ground_station; }));

  keys.push_back(text_key(
      "radio", "key",
      "32 hexadecimal digits, then a blank and the robot's id if it is not 1; or none",
      "command key of robot and ground station; left out: the test key 00 01 .. 0F; none: the "
      "robot has no key",
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

  keys.push_back(real_key("physics", "step", "s", 1e-5, 0.01, "integration step; divides 0.01 s",
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

}  // namespace

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

const std::vector<ExperimentKey>& experiment_keys() {
  static const std::vector<ExperimentKey> table = make_keys();
  return table;
}

int16_t algorithm_number(const std::string& name) {
  for (const ValueInfo& known : algorithms()) {
    if (name == known.name) return static_cast<int16_t>(known.value);
  }
  throw InputError("unknown algorithm '" + name + "'");
}

}  // namespace screed
