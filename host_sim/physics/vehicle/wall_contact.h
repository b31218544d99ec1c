// A robot's body against the vertical walls of a bed (BedEdge::kWalled), which have no top.
//
// Every point of the body, of its running gear too, that is beyond a wall meets the law of
// running_gear.h: a spring and damper that never pull, elastic bristles with Coulomb's limit.
// Walls are as stiff as boards, and up to a whole side of a track touches them at a time: explicit
// forces would need steps far below a millisecond. So all points of a body in a step are solved
// together, as the forces of the step's end, with the velocities u' that they leave:
//
//   normal   p_n = max(0, dt (k d - (c + dt k) n.u'))
//   friction p_t = -dt (k b + (c + dt k) t.(u' + s' a)),  |p_t| <= mu p_n
//
// p impulse of the step, d depth beyond the wall, n into the bed, t along the wall, b bristle,
// u' velocity of the body there, s' speed of the running gear's surface along a. A wheel that turns
// does not press deeper where its rim goes down: the normal part leaves s' out. The
// bristle is the way that the point has really slid, whatever else pushed. Projected Gauss-Seidel
// with soft constraints: E. Catto, Soft constraints, Game Developers Conference 2011.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "host_sim/physics/terrain/footprint_contact.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/physics/vehicle/running_gear.h"

namespace screed {

/// What turns a surface of running gear: its motion now, and how it answers a wall.
struct SurfaceDrive {
  double omega_rad_per_s = 0.0;  ///< driving forward positive
  double inverse_inertia_per_kg_m2 = 0.0;
  double torque_n_m = 0.0;  ///< of the walls in this step: the answer
};

/// The drive of what no drive moves.
inline constexpr size_t kNoSurfaceDrive = static_cast<size_t>(-1);

/// A point on the outside of a body, in the frame of its centre of mass.
struct BodyPoint {
  Eigen::Vector3d at;
  Eigen::Vector3d along;  ///< which way its drive moves the surface, unit length; zero without one
  size_t drive;           ///< kNoSurfaceDrive without one
  double radius;          ///< speed of the surface over that of the drive, m
};

class WallContact {
 public:
  /// A point that no drive moves.
  void add_point(const Eigen::Vector3d& at);
  /// A point on a surface that drive `drive` moves along `along` (unit length) at `radius_m` times
  /// its speed. Both in the frame of the body's centre of mass.
  void add_point(const Eigen::Vector3d& at, const Eigen::Vector3d& along, size_t drive,
                 double radius_m);
  /// After the last point. `friction`: Coulomb coefficient of all points.
  void close(double friction, double robot_kg);

  /// Clears the state of all contacts.
  void reset_contacts();

  /// Whether a point could be beyond a wall while the centre of mass is there.
  bool within_reach(const BedBounds& bed, const Eigen::Vector3d& centre) const;
  /// Adds what the walls of `bed` do to the body in this step to `wrench`, and to the torques of
  /// `drives`.
  void press(const BedBounds& bed, const PressingBody& body, const Eigen::Matrix3d& rotation,
             double dt, std::vector<SurfaceDrive>& drives, Wrench& wrench);

  /// One point on a wall in the last step.
  struct Touch {
    size_t point;
    size_t axis;              ///< of the world that the wall's normal lies along: 0 x, 1 y
    Eigen::Vector3d normal;   ///< into the bed
    double depth;             ///< m
    Eigen::Vector3d arm;      ///< from the body's centre of mass, world axes
    Eigen::Vector3d along;    ///< of the running gear's surface, world axes; zero without a drive
    Eigen::Vector3d impulse;  ///< of the step, N s

    /// The part of the impulse along the wall.
    Eigen::Vector3d friction() const { return impulse - impulse.dot(normal) * normal; }
  };
  const std::vector<Touch>& touches() const { return touches_; }
  static constexpr size_t kNoDrive = kNoSurfaceDrive;
  size_t points() const { return points_.size(); }
  /// In the frame of the body's centre of mass.
  const Eigen::Vector3d& point(size_t i) const { return points_[i].at; }
  /// As given to add_point().
  const BodyPoint& body_point(size_t i) const { return points_[i]; }
  size_t drive(size_t point) const { return points_[point].drive; }
  /// Of the points from the centre of mass, m.
  double reach_m() const { return reach_; }

 private:
  using Point = BodyPoint;
  struct Memory {  // of a point on the walls across one axis
    Eigen::Vector3d bristle = Eigen::Vector3d::Zero();
    Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
    bool touching = false;
  };
  struct Motion;  // of body and drives, as the impulses change it

  void find_touches(const BedBounds& bed, const PressingBody& body,
                    const Eigen::Matrix3d& rotation);
  double solve(const Touch& touch, const Memory& memory, double dt, Motion& motion,
               Eigen::Vector3d& impulse) const;
  Memory& memory_of(const Touch& touch) { return memories_[touch.axis][touch.point]; }

  std::vector<Point> points_;
  std::array<std::vector<Memory>, 2> memories_;  // by axis: no point is beyond two opposite walls
  std::vector<Touch> touches_;
  double stiffness_ = 0.0;  // N/m per point
  double damping_ = 0.0;    // N s/m per point
  double friction_ = 0.0;
  double tolerance_ = 0.0;  // N s
  double reach_ = 0.0;      // of the points from the centre of mass, for the broad phase
  bool touched_ = false;    // any state to be cleared
};

}  // namespace screed
