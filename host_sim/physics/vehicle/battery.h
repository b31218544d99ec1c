// A battery of NiMH cells: charge, discharge curve, internal resistance.
#pragma once

#include <algorithm>
#include <optional>

#include "host_sim/core/nimh_cell.h"

namespace screed {

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

}  // namespace screed
