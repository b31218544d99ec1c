// Robot models in the style of ROS, for tests: names, frames and shapes as published models have
// them, as text; and wheels as STL and Collada meshes.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace screed::testing {

struct RosWheel {
  std::string link;
  std::string joint;
  std::string place;  // xyz of the joint
};

struct RosRobot {
  std::string chassis = "base_link";
  bool has_footprint = false;  // a root without mass below the chassis
  std::array<RosWheel, 4> wheels = {
      {{"front_left_wheel_link", "front_left_wheel", "0.09 0.0975 0"},
       {"front_right_wheel_link", "front_right_wheel", "0.09 -0.0975 0"},
       {"rear_left_wheel_link", "rear_left_wheel", "-0.09 0.0975 0"},
       {"rear_right_wheel_link", "rear_right_wheel", "-0.09 -0.0975 0"}}};
  std::array<std::string, 4> parents = {};  // of the wheels' joints; empty: the chassis
  std::string joint_rpy = "0 0 0";
  std::string axis = "0 1 0";
  std::string wheel_shapes =
      "<collision><origin rpy=\"1.5707963267948966 0 0\"/><geometry><cylinder radius=\"0.03\" "
      "length=\"0.03\"/></geometry></collision>";
  std::string wheel_joint = "continuous";
  std::string limit;  // of each wheel's joint
  std::string chassis_size = "0.2 0.14 0.05";
  std::string extra;  // before </robot>
};

inline std::string solid(const std::string& mass, const std::string& moment) {
  std::string text = "<inertial><mass value=\"";
  text += mass;
  text += "\"/><inertia ixx=\"" + moment;
  text += "\" ixy=\"0\" ixz=\"0\" iyy=\"" + moment;
  text += "\" iyz=\"0\" izz=\"" + moment;
  return text + "\"/></inertial>";
}

inline std::string joint_text(const std::string& name, const std::string& type,
                              const std::string& parent, const std::string& child,
                              const std::string& inside = "") {
  std::string text = "<joint name=\"";
  text += name;
  text += "\" type=\"" + type;
  text += "\"><parent link=\"" + parent;
  text += "\"/><child link=\"" + child;
  text += "\"/>" + inside;
  return text + "</joint>\n";
}

inline std::string urdf_of(const RosRobot& robot) {
  std::string text = "<?xml version=\"1.0\"?>\n<robot name=\"ros\">\n";
  if (robot.has_footprint) {
    text += "<link name=\"base_footprint\"/>\n" + joint_text("base_joint", "fixed",
                                                             "base_footprint", robot.chassis,
                                                             "<origin xyz=\"0 0 0.03\"/>");
  }
  text += "<link name=\"" + robot.chassis;
  text += "\">" + solid("1", "0.004");
  text += "<collision><geometry><box size=\"" + robot.chassis_size;
  text += "\"/></geometry></collision></link>\n";
  for (std::size_t i = 0; i < robot.wheels.size(); ++i) {
    const RosWheel& wheel = robot.wheels[i];
    const std::string& parent = robot.parents[i].empty() ? robot.chassis : robot.parents[i];
    text += "<link name=\"" + wheel.link;
    text += "\">" + solid("0.1", "5e-5");
    text += robot.wheel_shapes + "</link>\n";
    std::string inside = "<origin xyz=\"" + wheel.place;
    inside += "\" rpy=\"" + robot.joint_rpy;
    inside += "\"/><axis xyz=\"" + robot.axis;
    inside += "\"/>" + robot.limit;
    text += joint_text(wheel.joint, robot.wheel_joint, parent, wheel.link, inside);
  }
  return text + robot.extra + "</robot>\n";
}

/// A drum of 48 corners about z as ASCII STL, in the unit of the numbers.
inline std::string drum_stl(double radius, double length) {
  constexpr int kCorners = 48;
  std::string text = "solid drum\n";
  const auto corner = [&](int i, double z) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    text += "vertex " + std::to_string(radius * std::cos(angle));
    text += " " + std::to_string(radius * std::sin(angle));
    text += " " + std::to_string(z) + "\n";
  };
  const auto facet = [&](const auto& corners) {
    text += "facet normal 0 0 0\nouter loop\n";
    corners();
    text += "endloop\nendfacet\n";
  };
  const double half = 0.5 * length;
  for (int i = 0; i < kCorners; ++i) {
    facet([&] {
      corner(i, -half);
      corner(i + 1, -half);
      corner(i + 1, half);
    });
    facet([&] {
      corner(i, -half);
      corner(i + 1, half);
      corner(i, half);
    });
  }
  return text + "endsolid drum\n";
}

/// A flat square of side 2 in x and y as Collada, in millimetres, moved up by 5 in its node; its
/// "up" is y, which is not to count.
inline std::string square_dae() {
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="millimeter" meter="0.001"/><up_axis>Y_UP</up_axis></asset>
  <library_geometries><geometry id="square"><mesh>
    <source id="places"><float_array id="numbers" count="12">-1 -1 0 1 -1 0 1 1 0 -1 1 0</float_array>
      <technique_common><accessor source="#numbers" count="4" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <vertices id="corners"><input semantic="POSITION" source="#places"/></vertices>
    <triangles count="2"><input semantic="VERTEX" source="#corners" offset="0"/><p>0 1 2 0 2 3</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="scene"><node id="node">
    <translate>0 0 5</translate><instance_geometry url="#square"/>
  </node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
)";
}

}  // namespace screed::testing
