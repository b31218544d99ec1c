#include "tools/screed/link/plot_signals.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "host_sim/render/picture/color_map.h"

namespace screed {
namespace {

constexpr Color kFlagColor = {0.80, 0.22, 0.16};
constexpr Color kClear = {1.0, 1.0, 1.0, 0.0};

/// Halfway to white: states that are no leveling states look different from those.
Color pale(Color color) {
  const auto half = [](double part) { return 0.5 + 0.5 * part; };
  return {half(color.red), half(color.green), half(color.blue)};
}

Color color_of(const std::string& path, std::int64_t value) {
  const auto index = static_cast<std::size_t>(std::max<std::int64_t>(0, value));
  return path == "leveling.state" ? state_color(index) : pale(category_color(index));
}

}  // namespace

PlotSignal::PlotSignal(const std::string& path) : path_(path) {
  const std::size_t point = path.find('.');
  message_ = find_message(std::string_view(path).substr(0, point));
  if (message_ != nullptr && point != std::string::npos) {
    field_ = path.substr(point + 1);
    std::optional<std::uint8_t> first;
    for (const SignalInfo& it : message_->signals) {
      if (it.flags != field_) continue;
      first = std::min(first.value_or(it.start), it.start);
      mask_ |= std::uint64_t{1} << it.start;
    }
    if (first.has_value()) {
      first_bit_ = *first;
      return;
    }
  }
  const SignalRef found = find_signal(path);
  message_ = found.message;
  signal_ = found.signal;
}

bool PlotSignal::is_state() const {
  return signal_ == nullptr || !signal_->values.empty() || *signal_->flags != '\0';
}

std::int64_t PlotSignal::raw(std::uint64_t bits) const {
  if (signal_ != nullptr) return signal_->raw(bits);
  return static_cast<std::int64_t>((bits & mask_) >> first_bit_);
}

ChartBand PlotSignal::band(const BandInterval& interval) const {
  const std::int64_t value = interval.value;
  ChartBand band{interval.begin, interval.end, "", kFlagColor};
  const bool flags = signal_ == nullptr || *signal_->flags != '\0';
  if (flags) {
    if (value == 0) band.color = kClear;
    if (signal_ == nullptr) {
      band.name = flag_names(message_->title, field_, static_cast<std::uint32_t>(value));
    }
    return band;
  }
  band.name = signal_->text(value);
  band.color = color_of(path_, value);
  return band;
}

BandRow band_row(const PlotSignal& signal, const std::string& label,
                 const std::vector<StatePoint>& states, double log_end_s) {
  constexpr double kMissedPeriods = 5.0;
  constexpr double kMinGap_s = 1.0;
  // Of an event that is sent once the log says when, not for how long.
  const double period_s = signal.message().period_ms / 1000.0;
  const double gap_s = period_s > 0.0 ? std::max(kMinGap_s, kMissedPeriods * period_s) : 0.0;
  BandRow row{label, {}};
  for (const BandInterval& interval : band_intervals(states, period_s, gap_s, log_end_s)) {
    ChartBand band = signal.band(interval);
    if (band.color.alpha > 0.0) row.bands.push_back(std::move(band));
  }
  return row;
}

std::vector<ChartPoint> thinned(const std::vector<ChartPoint>& points, std::size_t groups) {
  if (points.size() <= 4 * groups) return points;
  std::vector<ChartPoint> thin;
  thin.reserve(2 * groups);
  for (std::size_t group = 0; group < groups; ++group) {
    const auto begin = points.begin() + static_cast<long>(group * points.size() / groups);
    const auto end = points.begin() + static_cast<long>((group + 1) * points.size() / groups);
    auto [low, high] = std::minmax_element(
        begin, end, [](const ChartPoint& a, const ChartPoint& b) { return a.y < b.y; });
    if (high < low) std::swap(low, high);
    thin.push_back(*low);
    if (high != low) thin.push_back(*high);
  }
  return thin;
}

}  // namespace screed
