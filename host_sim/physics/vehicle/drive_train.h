// What turns a track: battery, gear motor, shaft.
#pragma once

#include <algorithm>
#include <optional>

#include "host_sim/core/nimh_cell.h"

namespace screed {

// The two DC gear motors of the robot, in SI units at the gearbox's output shaft.

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

// A battery of NiMH cells: charge, discharge curve, internal resistance.

/// The Rover 5's as docs/wiring.md builds it.
struct Battery {
  /// At this share of the charge a spare one is put in.
  static constexpr double kReplacedAt = 0.1;

  int cells = 6;                     ///< in series
  double capacity_c = 2.0 * 3600.0;  ///< A s
  double resistance_ohm = 0.15;      ///< of cells, holder and leads
  double electronics_a = 0.12;       ///< board, sensors, radio
  int spares = 0;                    ///< full ones to come; a robot waits for none

  double drawn_c = 0.0;   ///< since it was full
  double used_c = 0.0;    ///< since the start, of all of them
  double energy_j = 0.0;  ///< drawn at the terminals since the start
  double terminal_v = 6 * 1.4;

  /// Share of its charge that is left, 0..1; below 0 where more was drawn.
  double charge() const { return 1.0 - drawn_c / capacity_c; }

  /// At rest. charge: 0..1.
  void begin_with(double charge) {
    drawn_c = (1.0 - charge) * capacity_c;
    terminal_v = cells * nimh_cell_v(charge);
  }

  /// How long a full battery lasts at the mean current since the start; nothing before it.
  std::optional<double> lasts_s(double since_start_s) const {
    if (!(used_c > 0.0)) return std::nullopt;
    return since_start_s * capacity_c / used_c;
  }

  /// Takes that much charge out, A s, and puts spares in when it is time.
  void draw(double charge_c) {
    used_c += charge_c;
    const double usable_c = (1.0 - kReplacedAt) * capacity_c;
    for (; spares > 0 && drawn_c + charge_c > usable_c; --spares) {
      charge_c -= std::max(0.0, usable_c - drawn_c);
      drawn_c = 0.0;
    }
    drawn_c += charge_c;
  }

  /// Draws `motor_current_a` (and the electronics' share) for dt seconds.
  void step(double motor_current_a, double dt) {
    const double current = motor_current_a + electronics_a;
    terminal_v = std::max(0.0, cells * nimh_cell_v(charge()) - resistance_ohm * current);
    draw(current * dt);
    energy_j += terminal_v * current * dt;
  }
};

// Wheels that turn together, and the gear motors that turn them: one degree of freedom.
//
// It is the exact motion of wheels on fixed axles, gyroscopic torques of the slow wheels left out,
// and it needs no joint that a solver would have to hold together. The wheels' mass rides with the
// body that carries them.

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
  /// What its motors have done since the start while they drove it, J.
  double motor_work_j() const { return motor_work_; }

 private:
  GearMotor motor_;
  int motors_;
  double inertia_;
  double gain_;      ///< torque on a shaft that stands, N m per V
  double friction_;  ///< N m
  double omega_ = 0.0;
  double angle_ = 0.0;
  double current_ = 0.0;
  double motor_work_ = 0.0;
};

}  // namespace screed
