// `screed plot LOG attitude.pitch ... --out x.svg`: signals of a log over time.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/ground_station/telemetry/candump_log.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "host_sim/render/chart/plot_plan.h"
#include "host_sim/render/chart/stacked_chart.h"

namespace screed {

struct PlotOptions {
  std::string log;                   ///< as candump -L writes it; "-": standard input
  std::vector<std::string> signals;  ///< "message.signal", or "message.field" of flags
  std::string out;                   ///< .svg or .png
  std::optional<int> robot;          ///< one robot only; none: all
  double from_s = 0.0;               ///< since the log's first message
  std::optional<double> to_s;
  int width_px = 960;
  std::optional<int> height_px;  ///< none: as much as the panels need
};

/// The chart of a log: a panel for each unit, states and flags as bands; what could not be read is
/// reported on `err`. Throws InputError for an unknown signal, and when there is nothing to draw.
StackedChart plot_chart(const PlotOptions& options, std::ostream& err);

/// Draws it; returns 0. Throws InputError as above and for another ending than .svg or .png,
/// RunError when the file cannot be written.
int run_plot(const PlotOptions& options, std::ostream& err);

// Signals of a radio log as a plot needs them: which of them are states, and what the log says of
// each robot's.

/// A signal to plot: one of the schema, or all flags of a field together ("heartbeat.faults").
class PlotSignal {
 public:
  /// Throws InputError that names what there is.
  explicit PlotSignal(const std::string& path);

  const std::string& path() const { return path_; }
  const MessageInfo& message() const { return *message_; }
  const char* unit() const { return signal_ == nullptr ? "" : signal_->unit; }
  /// Values with names, and flags.
  bool is_state() const;
  /// An angle from 0 to a full turn: it jumps where it goes on beyond either end.
  bool is_full_turn() const {
    return signal_ != nullptr && !signal_->is_signed && std::string_view(unit()) == "deg";
  }
  /// Of the 8 bytes of a message as one number: the raw value, or all flags of the field.
  std::int64_t raw(std::uint64_t bits) const;
  /// In its unit; of a number.
  double value(std::int64_t raw) const { return signal_->value(raw); }
  /// A state as a band. A flag that is clear has none: its name is empty and its colour
  /// transparent.
  ChartBand band(const BandInterval& interval) const;

 private:
  std::string path_;
  const MessageInfo* message_;
  const SignalInfo* signal_ = nullptr;  ///< null: all flags of `field_`
  std::string field_;
  std::uint8_t first_bit_ = 0;
  std::uint64_t mask_ = 0;
};

/// What a log says of one signal of one robot, in the order of time.
struct SignalPoints {
  std::vector<ChartPoint> numbers;  ///< of no state
  std::vector<StatePoint> states;
};

/// A row of bands of a state, none of which goes beyond the end of the log.
BandRow band_row(const PlotSignal& signal, const std::string& label,
                 const std::vector<StatePoint>& states, double log_end_s);

/// The same line with about two points for each of `groups` parts of it, the lowest and the highest
/// of each, so that no peak is lost.
std::vector<ChartPoint> thinned(const std::vector<ChartPoint>& points, std::size_t groups);

}  // namespace screed
