// A robot as plain data: bodies with inertia and geometry, and the joints between them. The URDF
// importer fills it, the physics and the picture read it. It knows neither URDF nor ODE.
//
// Units: metres, kilograms, radians. Frames: x forward, y left, z up, right-handed. The ROOT frame
// is the frame of the chassis, with every joint at zero unless the importer was told to hold it
// elsewhere.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace screed {

struct Box {
  Eigen::Vector3d size;  // full edge lengths, m, centred on its frame
};

struct Cylinder {
  double radius;  // m
  double length;  // m, along z of its frame, centred on it
};

struct Sphere {
  double radius;  // m, centred on its frame
};

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;      // m, no two alike
  std::vector<std::array<int, 3>> triangles;  // indices of vertices, counter-clockwise from outside
};

struct Shape {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // in the frame of its body
  std::variant<Box, Cylinder, Sphere, TriangleMesh> geometry;
};

struct Inertia {
  double mass = 0.0;                                       // kg; 0 = a massless frame
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // centre of mass, axes of `tensor`
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();        // kg m^2, about the centre of mass
};

struct AssemblyBody {
  std::string name;
  Inertia inertia;  // in the frame of this body
  std::vector<Shape> collision;
  std::vector<Shape> visual;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // of this body, in the root frame
};

struct AssemblyJoint {
  enum class Kind { Fixed, Revolute, Motor };  // Motor: driven, and turns without end

  std::string name;
  Kind kind = Kind::Fixed;
  int parent = -1;  // index into Assembly::bodies
  int child = -1;   // likewise; every body is the child of at most one joint
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // of the joint frame, in the root frame;
                                                           // the same as that of the child
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();         // unit length, in the root frame
  bool limited = false;  // whether lower_rad and upper_rad stop the joint
  double lower_rad = 0.0;
  double upper_rad = 0.0;
  double effort_n_m = 0.0;  // greatest torque, N m; 0 = not given
};

/// What the robot rolls on: a cylinder about an axle along y of the chassis (wheel_rim.h).
struct AssemblyWheel {
  int body = -1;                                     // index into Assembly::bodies
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the cylinder, in the root frame
  double radius_m = 0.0;
  double width_m = 0.0;
  const char* source = "";  // what the numbers were taken from, for people: "collision cylinder"
};

/// A tree of bodies. Bodies and joints keep the order of the file they came from.
struct Assembly {
  std::string name;
  std::vector<AssemblyBody> bodies;
  std::vector<AssemblyJoint> joints;

  // Roles, as indices of bodies.
  int chassis = -1;
  int imu = -1;  // -1: the IMU is at the origin of the chassis
  /// [left, right][front, rear]
  std::array<std::array<AssemblyWheel, 2>, 2> wheels;

  bool is_wheel(int body) const;
  /// The joint whose child is `body`; null for the root.
  const AssemblyJoint* joint_to(int body) const;

  /// Index of the body or joint of that name, -1 when there is none.
  int body_index(std::string_view body_name) const;
  int joint_index(std::string_view joint_name) const;
};

/// The same inertia seen from another frame: `frame` is the pose, in that other frame, of the one
/// `inertia` is given in.
Inertia transformed(const Eigen::Isometry3d& frame, const Inertia& inertia);

/// One inertia for parts that are rigidly attached to each other and given in one common frame. The
/// result is about the common centre of mass, with the axes of the common frame. Parallel axis
/// theorem (Huygens-Steiner):
///   I = sum R_i I_i R_i^T + m_i (|d_i|^2 E - d_i d_i^T)
///   d_i = c_i - c,  c = sum m_i c_i / sum m_i
/// Massless parts add their moments alone; without any mass the result is an Inertia{}.
Inertia compose(const std::vector<Inertia>& parts);

/// The bodies that move as one with `body`: itself and everything reachable over fixed joints, in
/// ascending order.
std::vector<int> rigid_group(const Assembly& assembly, int body);

/// The inertia of these bodies together, in the root frame.
Inertia composed_inertia(const Assembly& assembly, const std::vector<int>& bodies);

}  // namespace screed
