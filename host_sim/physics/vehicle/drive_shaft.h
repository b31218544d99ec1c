// Wheels that turn together, and the gear motors that turn them: one degree of freedom.
//
// It is the exact motion of wheels on fixed axles, gyroscopic torques of the slow wheels left out,
// and it needs no joint that a solver would have to hold together. The wheels' mass rides with the
// body that carries them.
#pragma once

#include "host_sim/physics/vehicle/gear_motor.h"

namespace screed {

class DriveShaft {
 public:
  /// inertia_kg_m2: of the wheels about their axles; the motors' own comes on top.
  DriveShaft(const GearMotor& motor, int motors, double inertia_kg_m2);

  /// Advances the shaft over dt seconds under `torque_n_m` of the terrain, with its motors at
  /// `voltage` (their terminals shorted at 0: the driver brakes).
  void step(double voltage, double torque_n_m, double dt);
  /// Stops it at once.
  void halt() { omega_ = 0.0; }
  /// Lets it turn at this speed from now on.
  void spin(double omega_rad_per_s) { omega_ = omega_rad_per_s; }

  bool driven() const { return motors_ > 0; }
  double omega_rad_per_s() const { return omega_; }
  double angle_rad() const { return angle_; }        ///< since the start
  double current_a() const { return current_; }      ///< of all its motors
  double inertia_kg_m2() const { return inertia_; }  ///< motors included

 private:
  GearMotor motor_;
  int motors_;
  double inertia_;
  double gain_;      ///< torque on a shaft that stands, N m per V
  double friction_;  ///< N m
  double omega_ = 0.0;
  double angle_ = 0.0;
  double current_ = 0.0;
};

}  // namespace screed
