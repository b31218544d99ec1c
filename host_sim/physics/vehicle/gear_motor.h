// The two DC gear motors of the robot, in SI units at the gearbox's output shaft.
#pragma once

namespace screed {

/// A brushed DC gear motor. The defaults are the Dagu Rover 5's: 7.2 V nominal, 2.5 A stall
/// current, 25 cm/s on wheels of 30 mm, stall torque 10 kg cm at the output (data sheet). From
/// these follow R = 7.2 V / 2.5 A, the back-EMF constant k = (V - I0 R) / omega0, and the gearbox's
/// efficiency: stall torque / (k I_stall) = 0.49.
struct GearMotor {
  double resistance_ohm = 2.88;
  /// V per rad/s of the output shaft; also N m per A before gearbox losses.
  double back_emf_v_s = 0.81;
  double efficiency = 0.485;  ///< of the gearbox, on the motor's torque
  /// Estimate; its torque is the Coulomb friction of motor, gearbox and track.
  double no_load_current_a = 0.16;
  double inertia_kg_m2 = 7.5e-4;  ///< rotor (1e-7 kg m^2, estimate) times 86.8 squared

  /// Current at a terminal voltage and shaft speed (rad/s).
  double current(double voltage, double omega) const {
    return (voltage - back_emf_v_s * omega) / resistance_ohm;
  }
  double torque_per_ampere() const { return back_emf_v_s * efficiency; }
  double friction_torque() const { return torque_per_ampere() * no_load_current_a; }
};

}  // namespace screed
