// Bekker's law in closed form; tables of its powers, shared between worlds.
#include "host_sim/physics/soil/soil_laws.h"

#include <cmath>
#include <mutex>

#include "host_sim/core/elementary.h"

namespace screed {

namespace {

struct KnownTables {
  double n;
  double step;
  size_t count;
  std::weak_ptr<const PowerTables> tables;
};
constinit std::mutex known_in_use;
constinit std::vector<KnownTables> known;

}  // namespace

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

std::shared_ptr<const PowerTables> power_tables(double n, double step, double most_more) {
  const auto count = static_cast<size_t>(std::ceil(most_more / step)) + 1;
  const std::lock_guard lock(known_in_use);
  std::erase_if(known, [](const KnownTables& entry) { return entry.tables.expired(); });
  for (const KnownTables& entry : known) {
    if (entry.n != n || entry.step != step || entry.count != count) continue;
    if (std::shared_ptr<const PowerTables> tables = entry.tables.lock()) return tables;
  }
  PowerTables made;
  made.reserve(count);
  for (size_t i = 0; i < count; ++i) made.emplace_back(n + static_cast<double>(i) * step);
  auto tables = std::make_shared<const PowerTables>(std::move(made));
  known.push_back({n, step, count, tables});
  return tables;
}

}  // namespace screed
