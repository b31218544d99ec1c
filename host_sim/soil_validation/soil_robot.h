// The robot of the timing test: one rigid body in ODE on four driven wheels whose spin is imposed.
// Not the Rover (host_sim/physics/vehicle): a plain body that any engine can rebuild.
#pragma once

#include <array>
#include <string>

#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/vehicle/ode_world.h"

namespace screed {

/// Masses and places as in docs/studies/soil.md.
struct SoilRobotShape {
  double wheel_radius_m = 0.03;
  double wheel_width_m = 0.025;
  double wheelbase_m = 0.17;
  double track_m = 0.20;
  double chassis_kg = 0.8;
  double wheel_kg = 0.1;
  Eigen::Vector3d chassis_m{0.25, 0.15, 0.06};
  double chassis_above_axles_m = 0.02;
};

class SoilRobot {
 public:
  /// Puts the robot down on the bed at (x, y), heading along x; the bed must outlive it.
  SoilRobot(SoilBed& bed, const SoilRobotShape& shape, double x, double y);

  /// One step of soil and bodies with these rim speeds, m/s.
  void step(double left_m_per_s, double right_m_per_s, double dt);

  Eigen::Vector3d position() const;  ///< of the centre of mass
  Eigen::Vector3d velocity() const;
  Eigen::Matrix3d rotation() const;
  double load_n() const { return load_; }  ///< that the soil supported in the last step

 private:
  struct Wheel {
    Eigen::Vector3d place;  // from the centre of mass
    Footprint footprint;
    ContactMemory memory;
  };

  SoilBed& bed_;
  OdeWorld world_;
  dBodyID body_;
  std::array<Wheel, 4> wheels_;
  double mass_ = 0.0;
  Eigen::Matrix3d inverse_inertia_;  // about the centre of mass, in the body's axes
  BodyMemory memory_;
  double load_ = 0.0;
};

/// A fingerprint of all heights of a surface.
std::string surface_hash(const HeightField& surface);

}  // namespace screed
