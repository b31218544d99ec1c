// Bekker's law in closed form, and the table of its powers.
#include "host_sim/physics/soil/soil_laws.h"

#include <cmath>

#include "host_sim/core/elementary.h"

namespace screed {

double bekker_pressure_pa(const SoilParameters& soil, double breadth_m, double depth_m) {
  return bekker_modulus(soil, breadth_m) * portable::pow(depth_m, soil.exponent);
}

double bekker_depth_m(const SoilParameters& soil, double breadth_m, double pressure_pa) {
  return portable::pow(pressure_pa / bekker_modulus(soil, breadth_m), 1.0 / soil.exponent);
}

PowerTable::PowerTable(double exponent) : exponent_(exponent), lines_(kLines) {
  double low = 0.0;
  double low_power = 0.0;
  for (int64_t i = 0; i < kLines; ++i) {
    const double high = std::bit_cast<double>((kFirst + i) << kDropped);
    const double high_power = portable::pow(high, exponent);
    Line& line = lines_[static_cast<size_t>(i)];
    line.slope = (high_power - low_power) / (high - low);
    line.offset = high_power - line.slope * high;
    low = high;
    low_power = high_power;
  }
}

}  // namespace screed
