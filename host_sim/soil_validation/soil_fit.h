// Fits a soil's parameters to measurements: least squares over the limits of wheels
// (wheel_limit.h) and Bekker's law for plates, with the uncertainty of each parameter.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/soil_validation/soil_measurements.h"

namespace screed {

/// Of the rim against soil, beside the soil's own parameters.
struct RimSurface {
  double friction;  ///< tangent of the angle
  double adhesion_pa;
};

struct SoilFitProblem {
  SoilParameters soil;  ///< where the fit begins; what is not free stays
  RimSurface rim;
  /// Keys of soil parameters (k_phi, n, ...), and rim_friction, rim_adhesion.
  std::vector<std::string> free;
  SoilMeasurements measured;
};

struct FittedParameter {
  std::string key;
  double start;
  double value;
  /// Standard error from the curvature of the sum of squares and the spread that is left; no number
  /// where the measurements do not determine it, or where it lies at a bound.
  double standard_error;
  bool at_bound;
  /// False: the measurements are fitted as well with other values, alone or together with other
  /// parameters, over most of its range.
  bool determined;
};

struct SoilFit {
  SoilParameters soil;
  RimSurface rim;
  std::vector<FittedParameter> parameters;
  double spread = 0.0;  ///< root of the mean square of what is left, in the errors below; 1 is good
  /// Of the fits from every start, each by itself, the best first.
  std::vector<double> spreads;
  int residuals = 0;
  int evaluations = 0;
};

/// Errors that measurements are taken to have: of a force the greater part of 3 % of the load and
/// 10 % of its value (their squares add), of a sinkage or a plate's pressure 10 %, of a torque 3 %
/// of load times radius and 10 %, of
/// what slip sinks a wheel in addition 10 %, 0.3 mm and what the row states. The fit begins at the
/// problem's soil and at the best of many places in the ranges of the free parameters (of 300
/// eleven, with wheels of 40 three); the best end is the answer. Throws InputError for an unknown
/// key, one twice, and fewer measurements than parameters. `progress` is told how many evaluations
/// were made.
SoilFit fit_soil(const SoilFitProblem& problem, const std::function<void(int)>& progress = {});

/// A wheel of the measurements on this soil, with this rim: the limit, and where the load sinks it
/// to its axle the forces there.
WheelReaction predicted_wheel(const RollingWheel& wheel, const SoilParameters& soil,
                              const RimSurface& rim);
/// What a wheel of the measurements sinks in addition at its places, m.
std::vector<double> predicted_transient(const MeasuredTransient& transient,
                                        const SoilParameters& soil, const RimSurface& rim);

}  // namespace screed
