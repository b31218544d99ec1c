// One degree of freedom: wheels and their motors.
#include "host_sim/physics/vehicle/drive_train.h"

#include <algorithm>
#include <cmath>

namespace screed {

namespace {

constexpr double kBearingTorque_n_m = 6e-4;  // of a wheel without a motor

}  // namespace

DriveShaft::DriveShaft(const GearMotor& motor, int motors, double inertia_kg_m2)
    : motor_(motor),
      motors_(motors),
      inertia_(inertia_kg_m2 + motors * motor.inertia_kg_m2),
      gain_(motors * motor.torque_per_ampere() / motor.resistance_ohm),
      friction_(driven() ? motors * motor.friction_torque() : kBearingTorque_n_m) {}

void DriveShaft::step(double voltage, double torque_n_m, double dt) {
  // I dw/dt = motors torque_per_ampere (V - k w) / R + terrain - friction; back-EMF implicit,
  // friction never past standstill.
  const double resist = gain_ * motor_.back_emf_v_s;
  const double pushed = omega_ + (torque_n_m + gain_ * voltage) * dt / inertia_;
  const double stopped_by = friction_ * dt / inertia_;
  omega_ = std::abs(pushed) <= stopped_by
               ? 0.0
               : (pushed - std::copysign(stopped_by, pushed)) / (1.0 + resist * dt / inertia_);
  angle_ += omega_ * dt;
  current_ = motors_ * motor_.current(voltage, omega_);
  motor_work_ += std::max(0.0, motor_.torque_per_ampere() * current_ * omega_) * dt;
}

}  // namespace screed
