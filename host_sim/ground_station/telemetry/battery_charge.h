// How full a battery of NiMH cells is, from its voltage.
#pragma once

#include <optional>
#include <string>

namespace screed {

/// 0 empty .. 1 full, by the voltage of a cell; nothing without cells, or when the voltage is none
/// of such a battery (below 0.8 V or above 1.6 V a cell: the robot runs on USB, or has other
/// cells).
///
/// A NiMH cell holds its voltage for most of its charge, and the motors lower it: the result is
/// good to some 15 %.
std::optional<double> battery_charge(double battery_v, int cells);

/// "7.95 V, 90 %"; without the charge where it is not known. Rounded down to steps of 5 %.
std::string battery_text(double battery_v, int cells);

/// Charge it soon: below this battery_charge().
constexpr double kLowCharge = 0.2;

}  // namespace screed
