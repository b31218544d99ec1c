// Robots against each other: every point on the outside of one body that is inside a solid part of
// another one's pushes both apart, with Coulomb friction.
//
// The points between two bodies share a spring and a damper by their depths (share s), so that the
// two meet with about the same stiffness however many points touch, and a point that has just come
// in changes nothing. With the velocities u of the step's beginning, as if each point were alone
// with the whole spring (so no step is too long for it):
//
//   normal   p_n = max(0, dt (k d - (c + dt k) n.u) / (1 + dt (c + dt k) m_n)) s
//   friction p_t = -u_t s / m_t, |p_t| <= mu p_n: what stops the sliding, within Coulomb's limit
//
// p impulse of the step, d depth, n out of the solid, m_n and m_t how an impulse there changes the
// velocities of both bodies along it (of running gear that of its drive too). Both bodies get the
// same impulse at the same place, in opposite directions: linear and angular momentum are kept.
// No memory of forces: two robots that lean on each other on a slope creep.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <vector>

#include "host_sim/physics/terrain/footprint.h"
#include "host_sim/physics/terrain/footprint_contact.h"
#include "host_sim/physics/vehicle/running_gear.h"
#include "host_sim/physics/vehicle/wall_contact.h"

namespace screed {

/// A solid part of a body, in the frame of the body's centre of mass.
struct SolidPart {
  Footprint shape;
  Eigen::Isometry3d pose;
  size_t drive = kNoSurfaceDrive;  ///< that moves its belt
  double radius_m = 0.0;           ///< speed of the belt over that of the drive
};

/// Running gear as a solid part.
SolidPart solid_of(const RunningGearGeometry& gear, size_t drive);
/// Points round running gear, half way between its edges: of two tracks in line the edges' points
/// are on each other's sides, and do not see that they stand in one another.
std::vector<BodyPoint> middle_of(const RunningGearGeometry& gear, size_t drive);

/// A body of a robot in this step, as another robot's body meets it.
struct RobotBody {
  PressingBody motion;
  Eigen::Matrix3d rotation;              ///< body to world
  double reach_m;                        ///< of points and solids from the centre of mass
  const std::vector<BodyPoint>& points;  ///< on its outside
  const std::vector<SolidPart>& solids;
  double robot_kg;                    ///< mass of the whole robot
  std::vector<SurfaceDrive>& drives;  ///< of the whole robot; get the answer
  Wrench& wrench;                     ///< gets the answer
};

class RobotContact {
 public:
  /// `friction`: Coulomb coefficient between robots. `notice_m`: from how far on gap_m() sees one.
  explicit RobotContact(double friction, double notice_m = 0.0)
      : friction_(friction), notice_m_(notice_m) {}

  /// The longest step in which robots that meet stay calm, s.
  static constexpr double kLongestStep_s = 0.002;

  double notice_m() const { return notice_m_; }
  /// From a point of one robot to a solid of another, the least since forget_gap(), m: negative
  /// inside, infinite when none was within notice_m().
  double gap_m() const { return gap_m_; }
  void forget_gap() { gap_m_ = std::numeric_limits<double>::infinity(); }

  /// Adds what two bodies of different robots, near enough to touch, do to each other in this step.
  void press(const RobotBody& one, const RobotBody& other, double dt);
  /// How deep they stand in one another, m; 0 when they do not.
  double depth(const RobotBody& one, const RobotBody& other);

 private:
  struct Touch {
    const RobotBody* pointed;  // whose point it is
    const RobotBody* solid;    // whose solid it is in
    double depth;              // m
    Eigen::Vector3d normal;    // out of the solid
    Eigen::Vector3d at;        // world
    size_t point_drive;
    Eigen::Vector3d point_along;  // velocity of the surface over that of its drive, m
    size_t solid_drive;
    Eigen::Vector3d solid_along;
  };
  struct Side;  // a body at a touch

  void find_touches(const RobotBody& one, const RobotBody& other);
  void add_touches(const RobotBody& pointed, const RobotBody& solid);
  void push(const Touch& touch, double dt) const;

  double friction_;
  double notice_m_;
  double gap_m_ = std::numeric_limits<double>::infinity();
  std::vector<Touch> touches_;  // of two bodies in one step; kept for its room
  double total_depth_ = 0.0;    // of these, m
};

}  // namespace screed
