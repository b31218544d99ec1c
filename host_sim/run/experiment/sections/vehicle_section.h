// [vehicle] of an experiment file: the robot, and where it starts.
#pragma once

#include <algorithm>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace screed {

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
  }
};

}  // namespace screed
