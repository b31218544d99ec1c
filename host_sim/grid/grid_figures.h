// The experiments of thesis 4.2 and our comparison with them: which runs, and the tables and charts
// that are made of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/grid/grid_sweep.h"
#include "host_sim/render/chart/line_chart.h"

namespace screed {

struct GridFigure {
  std::string name;  ///< 4.2
  std::string title;
  std::vector<SweepPoint> points;
  bool shows_units = false;  ///< the chart shows units moved; otherwise cycles
  ChartKind kind = ChartKind::kLines;
  std::string x_label;
  std::vector<std::string> categories;  ///< of the x axis
  std::vector<std::string> series;      ///< names; point i belongs to series i % series
  /// Runs of several figures may stand in one file.
  std::string results_name;
};

/// Names of all figures.
const std::vector<std::string>& grid_figure_names();

/// Throws InputError for a name that there is not. `base` gives everything that the figure does not
/// vary.
GridFigure grid_figure(const std::string& name, const GridConfig& base);

/// The files of a figure: <folder>/figure-<name>.csv, one line a point, and .svg.
struct FigureFiles {
  std::filesystem::path csv;
  std::filesystem::path svg;
};
FigureFiles write_figure(const std::filesystem::path& folder, const GridFigure& figure,
                         const std::vector<std::vector<GridResult>>& results);

/// Cycles or units of the runs of a point.
Summary cycles_of(const std::vector<GridResult>& runs);
Summary units_of(const std::vector<GridResult>& runs);
size_t failures_of(const std::vector<GridResult>& runs);

}  // namespace screed
