// How full a battery of NiMH cells is.
#include "host_sim/ground_station/telemetry/battery_charge.h"

#include <cmath>
#include <cstdio>
#include <iterator>

namespace screed {
namespace {

constexpr double kMinCell_v = 0.8;
constexpr double kMaxCell_v = 1.6;

struct ChargePoint {
  double cell_v;
  double charge;
};
// The ends are those of VARTA Microbattery's NiMH data sheets (section "Definitions"): an
// open-circuit voltage of 1.4 V when full and 1.25 V on average, 1.0 V at the end of a discharge in
// five hours. Between them the flat curve that such data sheets draw of that discharge, read off at
// three points: the first tenth takes the voltage to 1.3 V, from 1.2 V on it falls off.
constexpr ChargePoint kCurve[] = {{1.00, 0.0}, {1.10, 0.05}, {1.20, 0.2},
                                  {1.25, 0.5}, {1.30, 0.9},  {1.40, 1.0}};

}  // namespace

std::optional<double> battery_charge(double battery_v, int cells) {
  if (cells < 1) return std::nullopt;
  const double cell_v = battery_v / cells;
  if (!(cell_v >= kMinCell_v && cell_v <= kMaxCell_v)) return std::nullopt;
  if (cell_v <= kCurve[0].cell_v) return 0.0;
  for (size_t i = 1; i < std::size(kCurve); ++i) {
    const ChargePoint& below = kCurve[i - 1];
    const ChargePoint& above = kCurve[i];
    if (cell_v < above.cell_v) {
      const double share = (cell_v - below.cell_v) / (above.cell_v - below.cell_v);
      return below.charge + share * (above.charge - below.charge);
    }
  }
  return 1.0;
}

std::string battery_text(double battery_v, int cells) {
  char text[48];
  const std::optional<double> charge = battery_charge(battery_v, cells);
  if (charge.has_value()) {
    std::snprintf(text, sizeof text, "%.2f V, %.0f %%", battery_v,
                  std::floor(*charge * 20.0 + 1e-6) * 5.0);
  } else {
    std::snprintf(text, sizeof text, "%.2f V", battery_v);
  }
  return text;
}

}  // namespace screed
