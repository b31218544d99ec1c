// `screed plot LOG attitude.pitch ... --out x.svg`: signals of a log over time.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

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

}  // namespace screed
