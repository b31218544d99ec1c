// The charts of `screed soil wheel`: sinkage, pull and side force over slip, beside the limit or
// beside measurements.
#pragma once

#include <string>
#include <vector>

#include "host_sim/render/chart/line_chart.h"
#include "host_sim/soil_validation/soil_measurements.h"
#include "host_sim/soil_validation/wheel_testbed.h"

namespace screed {

struct WheelChart {
  std::string file;  ///< its name
  Chart chart;
};

/// What a wheel does at a slip angle, over slip; lengths and forces as in WheelReaction.
struct WheelCurve {
  std::string label;
  bool markers;
  std::vector<double> slips;
  std::vector<WheelReaction> reactions;  ///< of each slip
};

struct WheelSweep {
  std::string prefix;    ///< of the files: soil_PREFIX_...
  std::string subject;   ///< follows the title
  std::string subtitle;  ///< of all charts
  std::vector<WheelCurve> curves;
  bool with_side_force;
};

/// soil_PREFIX_sinkage.svg, _pull.svg and, with_side_force, _side_force.svg. Points are joined in
/// the order of their slips.
std::vector<WheelChart> wheel_charts(const WheelSweep& sweep);

/// Measurements, and in the same rows what Screed and the limit give for them.
struct WheelComparison {
  std::string cases;     ///< that the rows were chosen by
  std::string subtitle;  ///< of all charts
  std::vector<MeasuredWheel> measured;
  std::vector<MeasuredWheel> screed;
  std::vector<MeasuredWheel> limit;
  std::vector<ChartPoint> chrono_pull;  ///< of Chrono, N over slip; may be empty
};

/// soil_measured_CASES_sinkage.svg, _pull.svg and _side_force.svg of what was measured. Measured
/// values are points with error bars (soil_measurements.h), Screed and limit are lines through the
/// means over the same trials; one set of each a slip angle. Measured values of a single slip angle
/// are black.
std::vector<WheelChart> measured_charts(const WheelComparison& comparison);

/// soil_schedule_sinkage.svg, _pull.svg and _side_force.svg over time, of what moves as a schedule
/// says.
std::vector<WheelChart> schedule_charts(const std::string& subject,
                                        const std::vector<WheelSample>& samples);

/// What a wheel sinks as its rim goes over to another speed, beside what was measured.
struct TransientComparison {
  MeasuredTransient measured;
  std::vector<WheelSample> screed;
};

/// soil_transient.svg: over the slip path.
WheelChart transient_chart(const std::string& subject,
                           const std::vector<TransientComparison>& transients);

}  // namespace screed
