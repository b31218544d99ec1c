// How full a battery of NiMH cells is.
#include "host_sim/ground_station/telemetry/battery_charge.h"

#include <cmath>
#include <cstdio>

#include "host_sim/core/nimh_cell.h"

namespace screed {
namespace {

constexpr double kMinCell_v = 0.8;
constexpr double kMaxCell_v = 1.6;

}  // namespace

std::optional<double> battery_charge(double battery_v, int cells) {
  if (cells < 1) return std::nullopt;
  const double cell_v = battery_v / cells;
  if (!(cell_v >= kMinCell_v && cell_v <= kMaxCell_v)) return std::nullopt;
  return nimh_charge(cell_v);
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
