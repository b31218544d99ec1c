// The sections of an experiment file that say what drives, and how: [experiment], [vehicle],
// [battery], [drive], [sensors], [radio], [fixes], [later], [metrics], [robots]. Each lists its
// keys once; experiment_keys.cpp reads and writes them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/ground_station/station/command_key.h"
#include "host_sim/ground_station/station/ground_station.h"

namespace screed {

// [experiment] of an experiment file: what runs, and for how long.

inline constexpr uint32_t kMaxFrames = 8U * INT16_MAX;  // eight blocks of a parameter's range

/// The names of [experiment] algorithm.
std::vector<std::string> algorithm_names();

struct ExperimentSection {
  std::string name = "experiment";
  std::string algorithm = "hill_sensing";
  double duration_s = 60.0;
  std::optional<uint32_t> frames;      ///< in place of duration_s; always set for training_drive
  std::optional<double> stop_after_s;  ///< of the training drive
  uint64_t seed = 1;
  double flatness_deg = 5.0;  ///< epsilon of the thesis' flatness, as a slope
  std::optional<double> lay_on_side_at_s;

  template <class Keys>
  static void list(Keys& keys) {
    using E = ExperimentSection;
    keys.text("name", "letters, digits, _ and -; at most 64", "names the run folder", &E::name,
              [](const std::string& text) {
                return !text.empty() && text.size() <= 64 &&
                       text.find_first_not_of(
                           "abcdefghijklmnopqrstuvwxyz"
                           "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") == std::string::npos;
              });
    keys.choice(
        "algorithm", algorithm_names(),
        "what the firmware does; training_drive: the drive for training data (thesis Algorithm 5)",
        &E::algorithm);
    keys.real("duration", "s", 0.01, 1e6, "simulated time", &E::duration_s)
        .replaces([](E& experiment) { experiment.frames.reset(); })
        .written_if([](const E& experiment) { return !experiment.frames.has_value(); });
    keys.integer("frames", "0.01 s", 8, kMaxFrames,
                 "in place of duration; algorithm training_drive: the n of Algorithm 5", &E::frames,
                 8);
    keys.real("stop_after", "s", 0.01, 1e4,
              "algorithm training_drive: the run ends when the drive has lasted so long, whatever "
              "its n",
              &E::stop_after_s);
    keys.integer("seed", "", 0, UINT64_MAX, "seed of every random generator of the world",
                 &E::seed);
    keys.real("flatness", "deg", 0.0, 89, "slope up to which ground counts as flat",
              &E::flatness_deg);
    keys.real("lay_on_side_at", "s", 0.01, 1e6, "fault: the robot is laid on its side at this time",
              &E::lay_on_side_at_s);
  }
};

// [vehicle] of an experiment file: the robot, and where it starts.

/// Names separated by blanks or commas.
inline std::vector<std::string> names_in(std::string text) {
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

struct VehicleSection {
  bool tracks = true;
  std::string track_model = "belt";
  int track_links = 0;
  double track_tension_n = 10.0;
  std::string model = "board";
  std::string chassis_link;
  std::string wheel_links;  ///< four names, separated by blanks or commas
  std::string imu_link;
  double x_m = 0.0;
  double y_m = 0.0;
  std::optional<double> z_m;
  double roll_deg = 0.0;
  double pitch_deg = 0.0;
  double heading_deg = 0.0;
  std::optional<double> leg_angle_deg;
  double track_friction = 0.8;
  double chassis_friction = 0.4;
  std::optional<double> lug_height_m;

  template <class Keys>
  static void list(Keys& keys) {
    using V = VehicleSection;
    keys.flag("tracks", "tracks round the wheels; false: four driven wheels", &V::tracks);
    keys.choice("track_model", {"belt", "chain"}, "what a track is; chain: links round its wheels",
                &V::track_model);
    keys.integer("track_links", "", 0, 400,
                 "track_model chain: links of each side; 0: as many as are about 10 mm long",
                 &V::track_links);
    keys.real("track_tension", "N", 1, 50, "track_model chain: tension of the chain at rest",
              &V::track_tension_n);
    const auto named = [](const std::string& text) { return !text.empty(); };
    keys.text("model", "a URDF file, rover5, four_wheels or board",
              "the robot; board: the one the board is built into", &V::model, named);
    keys.text("chassis_link", "a link of the model",
              "the chassis; left out: Body, base_link or the root", &V::chassis_link, named);
    keys.text("wheel_links",
              "four links of the model: front left, front right, rear left, rear right",
              "the wheels; left out: found by their names and places", &V::wheel_links,
              [](const std::string& text) { return names_in(text).size() == 4; });
    keys.text("imu_link", "a link of the model fixed to the chassis",
              "where the IMU is; left out: Imu, imu_link or the origin of the chassis",
              &V::imu_link, named);
    keys.real("x", "m", -500, 500, "start position, east", &V::x_m);
    keys.real("y", "m", -500, 500, "start position, north", &V::y_m);
    keys.real("z", "m", -200, 200, "start height of the chassis; left out: resting on the terrain",
              &V::z_m);
    keys.real("r", "deg", -180, 180, "start roll, left side up", &V::roll_deg);
    keys.real("p", "deg", -90, 90, "start pitch, nose up", &V::pitch_deg);
    keys.real("h", "deg", -360, 360, "start heading, counter-clockwise from east", &V::heading_deg);
    keys.real("leg_angle", "deg", -90, 90,
              "angle of the legs below the horizontal; left out: as in the model",
              &V::leg_angle_deg);
    keys.real("track_friction", "", 0.01, 5, "Coulomb friction between track or wheel and ground",
              &V::track_friction);
    keys.real("chassis_friction", "", 0.0, 5, "Coulomb friction between chassis and ground",
              &V::chassis_friction);
    keys.real("lug_height", "m", 0.0, 0.1,
              "deformable soil: height of the tread, which takes soil along; left out: 2 mm on "
              "tracks, none on wheels",
              &V::lug_height_m);
  }
};

// [battery] of an experiment file: what the robot drives on.

struct BatterySection {
  double charge = 1.0;
  std::optional<double> capacity_ah;
  int spares = 0;

  template <class Keys>
  static void list(Keys& keys) {
    using T = BatterySection;
    keys.real("charge", "", 0, 1, "share of its charge that the battery begins with", &T::charge);
    keys.real("capacity", "Ah", 0.01, 1000,
              "what it holds when full; left out: as battery.ini of the board says",
              &T::capacity_ah);
    keys.integer("spares", "", 0, 1000,
                 "full batteries to come: one is put in, and nothing waits for it, when a tenth of "
                 "the charge is left",
                 &T::spares);
  }
};

// [drive] of an experiment file: what the ground station commands.

struct DriveSection {
  double speed_m_per_s = 0.1;
  double yaw_rate_deg_per_s = 0.0;

  template <class Keys>
  static void list(Keys& keys) {
    keys.real("speed", "m/s", -0.5, 0.5, "algorithm drive: commanded speed",
              &DriveSection::speed_m_per_s);
    keys.real("yaw_rate", "deg/s", -179, 179, "algorithm drive: commanded turn rate",
              &DriveSection::yaw_rate_deg_per_s);
  }
};

// [sensors] of an experiment file: how true they are.

struct SensorsSection {
  bool noise = true;
  bool calibrated = true;
  bool calibration_motion = false;

  /// noise = false wins: an ideal IMU needs no calibration.
  ImuErrors imu_errors() const {
    if (!noise) return ImuErrors::quiet();
    return calibrated ? ImuErrors{} : ImuErrors::uncalibrated();
  }

  template <class Keys>
  static void list(Keys& keys) {
    using S = SensorsSection;
    keys.flag("noise",
              "noise, bias and scale errors as in the data sheets; false: quantisation alone",
              &S::noise);
    keys.flag(
        "calibrated",
        "what a calibration leaves of the chips' biases; false: as the chips come, unless noise is "
        "false",
        &S::calibrated);
    keys.flag("handled",
              "the IMU feels a person turning the robot over, as screed calibrate asks; the robot "
              "stands",
              &S::calibration_motion);
  }
};

// [radio] of an experiment file: the link between robot and ground station, and its key.

inline constexpr const char* kNoCommandKey = "none";  ///< [radio] key of a robot without one

struct RadioSection {
  double delay_s = 0.012;
  double loss = 0.0;
  double bit_errors = 0.0;
  double duplication = 0.0;
  std::optional<double> range_m;
  double baud = 58823.5;
  double packet_pause = 3.0;
  bool ground_station = true;
  std::string key;  ///< empty: the test key
  uint16_t boot_epoch = kFirstBootEpoch;

  template <class Keys>
  static void list(Keys& keys) {
    using R = RadioSection;
    keys.real("delay", "s", 0, 10,
              "latency of a packet, from its end in one module to its first byte out of the other",
              &R::delay_s);
    keys.real("loss", "", 0, 1, "probability that a packet is lost", &R::loss);
    keys.real("bit_errors", "", 0, 1, "probability that a bit of an arriving byte is wrong",
              &R::bit_errors);
    keys.real("duplication", "", 0, 1, "probability that an arriving packet comes twice",
              &R::duplication);
    keys.real("range", "m", 0.1, 100000,
              "distance at which half of the full packets are lost; left out: none is too far",
              &R::range_m);
    keys.real("baud", "baud", 1200, 1e6,
              "baud rate of the serial lines at the modules, 10 bits a byte", &R::baud);
    keys.real("packet_pause", "characters", 1, 255,
              "silence that ends a packet (the XBee's parameter RO)", &R::packet_pause);
    keys.flag("ground_station", "the ground station arms and starts the robot", &R::ground_station);
    keys.text("key",
              "32 hexadecimal digits, then a blank and the robot's id if it is not 1; or none",
              "command key of robot and ground station; left out: the test key 00 01 .. 0F; none: "
              "the robot has no key",
              &R::key, [](const std::string& text) {
                if (text == kNoCommandKey) return true;
                try {
                  parse_key(text, "");
                  return true;
                } catch (const InputError&) {
                  return false;
                }
              });
    keys.integer("boot_epoch", "", kFirstBootEpoch, UINT16_MAX,
                 "number of the robot's start, part of every command's freshness", &R::boot_epoch);
  }
};

// [fixes] of an experiment file: position fixes that the ground station sends, as from an overhead
// camera.

struct FixesSection {
  double period_s = 0.0;
  double sigma_m = 0.02;
  double outage_every_s = 0.0;
  double outage_s = 10.0;

  template <class Keys>
  static void list(Keys& keys) {
    using T = FixesSection;
    keys.real("period", "s", 0, 60,
              "time between two position fixes, rounded to 0.25 s; 0: none. They are in the map's "
              "axes",
              &T::period_s);
    keys.real("sigma", "m", 0, 1, "standard deviation of a fix along each axis", &T::sigma_m);
    keys.real("outage_every", "s", 0, 36000,
              "mean time from the end of an outage to the next one (exponential); 0: no outages",
              &T::outage_every_s);
    keys.real("outage", "s", 0, 36000, "how long an outage lasts", &T::outage_s);
  }
};

// [later] of an experiment file: live parameters that the ground station sets during the run.

struct LaterSection {
  std::optional<double> at_s;
  std::array<std::optional<int16_t>, Parameters::kCount> values;  ///< by number

  ParameterChanges changes() const {
    ParameterChanges changes{at_s.value_or(0.0), {}};
    for (uint8_t number = 0; number < Parameters::kCount; ++number) {
      if (values.at(number).has_value()) changes.values.push_back({number, *values.at(number)});
    }
    return changes;
  }

  template <class Keys>
  static void list(Keys& keys) {
    keys.real("at", "s", 0, 1e6, "from this time on the ground station sets the others",
              &LaterSection::at_s);
    for (const ParameterInfo& info : kParameterTable) {
      const auto number = static_cast<uint8_t>(info.number);
      if (!changes_while_running(number)) continue;
      keys.integer(info.name, info.unit, static_cast<uint64_t>(info.min),
                   static_cast<uint64_t>(info.max),
                   "in place of that of [parameters], from then on",
                   [number](LaterSection& later) -> std::optional<int16_t>& {
                     return later.values.at(number);
                   });
    }
  }
};

// [metrics] of an experiment file: how often a run is measured. Decides nothing of what happens in
// it.

struct MetricsSection {
  double interval_s = 30.0;
  double transport_interval_s = 120.0;

  template <class Keys>
  static void list(Keys& keys) {
    using M = MetricsSection;
    keys.real("interval", "s", 0.1, 1e6,
              "time between two points of the leveling curve; start and end are points as well",
              &M::interval_s)
        .default_not_written();
    keys.real("transport_interval", "s", 0, 1e6,
              "least time between two of these points with transport, on terrain that deforms; 0: "
              "start and end alone",
              &M::transport_interval_s)
        .default_not_written();
  }
};

// [robots] of an experiment file: how many share the bed, and where they start.

inline constexpr uint64_t kMaxRobots = 64;

/// Where a robot starts.
struct RobotPlace {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_deg = 0.0;
};

/// "x y heading" of each robot, separated by commas; nothing when it does not read like that.
inline std::optional<std::vector<RobotPlace>> places_in(const std::string& text) {
  constexpr double kFurthest_m = 500.0;
  constexpr double kTurn_deg = 360.0;
  std::vector<RobotPlace> places;
  std::istringstream list(text);
  for (std::string one; std::getline(list, one, ',');) {
    std::istringstream words(one);
    std::vector<double> numbers;
    for (std::string word; words >> word;) {
      const std::optional<double> number = finite_number<double>(word);
      if (!number.has_value()) return std::nullopt;
      numbers.push_back(*number);
    }
    if (numbers.size() != 3) return std::nullopt;
    for (const size_t axis : {0U, 1U}) {
      if (numbers[axis] < -kFurthest_m || numbers[axis] > kFurthest_m) return std::nullopt;
    }
    if (numbers[2] < -kTurn_deg || numbers[2] > kTurn_deg) return std::nullopt;
    places.push_back({numbers[0], numbers[1], numbers[2]});
  }
  if (places.empty()) return std::nullopt;
  return places;
}

struct RobotsSection {
  uint32_t count = 1;
  std::string placement = "grid";
  double spacing_m = 0.5;
  std::string places;  ///< as places_in() reads it
  double friction = 0.5;

  template <class Keys>
  static void list(Keys& keys) {
    using R = RobotsSection;
    keys.integer("count", "", 1, kMaxRobots, "robots on the bed, each with a ground station",
                 &R::count)
        .default_not_written();
    keys.choice("placement", {"grid", "ring", "random", "list"},
                "where several robots start: grid and ring round [vehicle] x, y; random by the "
                "seed; list: [robots] places",
                &R::placement)
        .default_not_written();
    keys.real("spacing", "m", 0.05, 100,
              "grid and ring: distance of neighbours; random: least distance of two robots",
              &R::spacing_m)
        .default_not_written();
    keys.text("places", "x y heading of each robot (m m deg), separated by commas",
              "placement list: where each robot starts", &R::places,
              [](const std::string& text) { return places_in(text).has_value(); });
    keys.real("friction", "", 0.0, 5, "Coulomb friction between robots", &R::friction)
        .default_not_written();
  }
};

}  // namespace screed
