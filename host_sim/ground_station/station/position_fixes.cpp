// Position fixes of a simulated camera.
#include "host_sim/ground_station/station/position_fixes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/sample.h"

namespace screed {
namespace {

// Fixes go up in ticks of their own: heartbeats take every 20th, other commands 12 of 25.
constexpr std::uint64_t kSlotTicks = kTickRate_hz / 4;
constexpr std::uint64_t kSlot = 7;
constexpr double kMaxCm = 2047.0;  // 12 bits

std::int16_t centimetres(double metres) {
  return static_cast<std::int16_t>(std::lround(std::clamp(metres * 100.0, -kMaxCm, kMaxCm)));
}

}  // namespace

PositionFixes::PositionFixes(std::uint64_t seed, const PositionFixOptions& options)
    : options_(options),
      period_ticks_(options.period_s <= 0.0
                        ? 0
                        : kSlotTicks * static_cast<std::uint64_t>(
                                           std::max(1L, std::lround(options.period_s * 4.0)))),
      random_(seed, "position fixes"),
      outages_(seed, "position fix outages"),
      outage_begins_s_(next_outage_s()) {}

double PositionFixes::next_outage_s() {
  if (options_.outage_every_s <= 0.0) return std::numeric_limits<double>::infinity();
  return -options_.outage_every_s * std::log(1.0 - outages_.uniform());
}

std::optional<DriveArgument> PositionFixes::at(std::uint64_t tick, double x_m, double y_m) {
  if (period_ticks_ == 0 || tick % period_ticks_ != kSlot) return std::nullopt;
  // Drawn for every fix: outages leave the noise of the others as it is.
  const double x = x_m + options_.sigma_m * random_.normal();
  const double y = y_m + options_.sigma_m * random_.normal();
  const double now_s = static_cast<double>(tick) / kTickRate_hz;
  while (now_s >= outage_begins_s_ + options_.outage_s)
    outage_begins_s_ += options_.outage_s + next_outage_s();
  if (now_s >= outage_begins_s_) return std::nullopt;
  return DriveArgument{centimetres(x), centimetres(y)};
}

}  // namespace screed
