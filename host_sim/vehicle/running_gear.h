// One unit of running gear: a belt around two wheels, or a single wheel, with the motor that drives
// it.
//
// A unit is a closed contour in a plane of the chassis, covered with contact points, whose surface
// moves along it at one speed. That speed is the unit's own degree of freedom (wheels, belt and
// rotor turn together); their mass rides with the chassis. It is the exact motion of a wheel on a
// fixed axle and of a belt that does not slip on its wheels, gyroscopic torques of the slow wheels
// left out, and it needs no joint that a solver would have to hold together.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "host_sim/soil/soil_bed.h"
#include "host_sim/terrain/height_field.h"
#include "host_sim/vehicle/gear_motor.h"
#include "host_sim/vehicle/ground_contact.h"

namespace screed {

/// Motion of the carrying body at this step, world frame.
struct CarrierMotion {
  Eigen::Vector3d origin;    ///< centre of mass
  Eigen::Matrix3d rotation;  ///< body to world
  Eigen::Vector3d velocity;  ///< of the centre of mass
  Eigen::Vector3d omega;
};

/// Sum of forces on the carrying body, about its centre of mass, world frame.
struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();

  void add(const Eigen::Vector3d& f, const Eigen::Vector3d& arm) {
    force += f;
    torque += arm.cross(f);
  }
};

struct RunningGearGeometry {
  Eigen::Vector3d
      front;  ///< centre of the front wheel, in the frame of the carrier's centre of mass
  Eigen::Vector3d rear;             ///< of the rear wheel; equal to `front` for a single wheel
  double radius = 0.03;             ///< m, belt included
  double width = 0.03;              ///< m
  double spin_inertia_kg_m2 = 0.0;  ///< of all wheels of the unit about their axles
};

class RunningGear {
 public:
  /// load_n: weight the unit carries on level ground; sets stiffness so that it sinks in 0.4 mm.
  /// mass_kg: the share of the robot's mass it carries, for critical damping.
  RunningGear(const RunningGearGeometry& geometry, bool driven, const GearMotor& motor,
              double friction, double load_n, double mass_kg);

  /// Contact forces of this step, added to `wrench`; remembers the ground's force along the belt.
  void contact(const HeightField& ground, const CarrierMotion& carrier, double dt, Wrench& wrench);

  /// The same on soil that gives way: the unit's lower surface presses into it.
  void contact(SoilBed& soil, const CarrierMotion& carrier, double dt, Wrench& wrench);

  /// Advances the surface speed with the motor at `voltage` (its terminals shorted at 0: the driver
  /// brakes).
  void drive(double voltage, double dt);

  /// Stops the surface at once and lets go of the ground.
  void halt();

  double speed_m_per_s() const { return speed_; }
  double angle_rad() const { return angle_; }  ///< of the wheels since the start
  double current_a() const { return current_; }
  double radius_m() const { return geometry_.radius; }
  double normal_load_n() const { return normal_load_; }
  const Eigen::Vector3d& centre() const { return centre_; }
  bool driven() const { return driven_; }
  /// The contour's points in the frame of the carrier's centre of mass.
  const std::vector<Eigen::Vector3d>& points() const { return points_; }

 private:
  void add_point(const Eigen::Vector3d& at, const Eigen::Vector3d& out,
                 const Eigen::Vector3d& along);
  void carry_bristles(double dt);
  void let_go(size_t point);

  RunningGearGeometry geometry_;
  bool driven_;
  GearMotor motor_;
  ContactLaw law_;
  double mass_;     ///< of rotor, wheels and belt as seen by the surface speed, kg
  double spacing_;  ///< between neighbours along the contour, m
  int rows_ = 2;    ///< contours side by side, at both edges of the belt
  Eigen::Vector3d centre_;

  // Point i of row r stands at index r * (count / rows) + i, in the order in which the material
  // passes when driving forward.
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector3d> outwards_;  ///< normal of the contour, unit length
  std::vector<Eigen::Vector3d> along_;     ///< direction of the material, unit length
  std::vector<Eigen::Vector3d> bristles_;  ///< world frame, m
  std::vector<Eigen::Vector3d> carried_;   ///< bristles before carry_bristles
  std::vector<uint8_t> bent_;              ///< whether a bristle may differ from zero

  double speed_ = 0.0;
  double angle_ = 0.0;
  double current_ = 0.0;
  Footprint footprint_;       ///< of the contour on soil, upright
  Footprint side_footprint_;  ///< of a unit that lies on its side
  Eigen::Matrix3d axes_;      ///< forward, left, up of the contour in the carrier's frame
  ContactMemory memory_;
  double load_mass_;           ///< the share of the robot that the unit carries, kg
  double ground_force_ = 0.0;  ///< of the ground on the surface, along the material's direction, N
  double normal_load_ = 0.0;
};

}  // namespace screed
