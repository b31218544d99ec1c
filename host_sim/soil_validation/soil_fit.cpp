// Levenberg and Marquardt's method (Eigen's, after MINPACK) over parameters that a sine keeps
// inside their bounds, from several starts.
#include "host_sim/soil_validation/soil_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "host_sim/soil_validation/plate_press.h"
#include "host_sim/soil_validation/wheel_testbed.h"

namespace screed {
namespace {

constexpr double kForceShareOfLoad = 0.03;
constexpr double kShareOfValue = 0.10;
// Of a test whose slip changes: cells and steps as coarse as leave its sinkage where it is.
constexpr double kCell_m = 0.01;
constexpr double kStep_s = 0.002;
constexpr double kMovingMass_kg = 2.0;
constexpr double kMinError_m = 6e-4;  // of what a wheel sinks in addition
constexpr double kDifference =
    1e-5;  // of a free variable, for derivatives: above the limit's noise
// Of the distance between the bounds: nearer than that, a parameter lies at its bound.
constexpr double kAtBound = 1e-3;
/// Where a fit begins: at the given place, and at the best of so many others.
struct Starts {
  int places;
  size_t best;
};
constexpr Starts kPlateStarts = {300, 11};
constexpr Starts kWheelStarts = {40, 3};  // a wheel takes a thousand times a plate's time
constexpr double kMaxDrawn = 1.2;         // of a variable, for a start: nearer its bound it is flat

/// A parameter between bounds as a variable without: value = low + (high - low) (1 + sin u) / 2, in
/// the logarithm where the range spans decades.
class Bounded {
 public:
  Bounded(double low, double high) : low_(low), high_(high) {
    logarithmic_ = high_ > 1e3 * std::max(low_, 1e-3);
    if (!logarithmic_) return;
    low_ = portable::log(std::max(low_, 1e-3));
    high_ = portable::log(high_);
  }
  double variable(double value) const {
    const double v = logarithmic_ ? portable::log(std::max(value, 1e-3)) : value;
    // Not at a bound itself, where the sine is flat.
    return portable::asin(std::clamp(2.0 * (v - low_) / (high_ - low_) - 1.0, -0.98, 0.98));
  }
  double value(double variable) const {
    const double v = low_ + 0.5 * (high_ - low_) * (1.0 + portable::sin(variable));
    return logarithmic_ ? portable::exp(v) : v;
  }
  double slope(double variable) const {
    const double d = 0.5 * (high_ - low_) * portable::cos(variable);
    return logarithmic_ ? d * value(variable) : d;
  }
  bool at_bound(double variable) const {
    return 1.0 - std::abs(portable::sin(variable)) < kAtBound;
  }

 private:
  double low_;
  double high_;
  bool logarithmic_ = false;
};

struct Free {
  std::string key;
  double* value;  // in the problem's soil or rim
  Bounded bounded;
  double start;
};

double error_of_force(double value, double scale) {
  return portable::hypot(kForceShareOfLoad * scale, kShareOfValue * value);
}

class Residuals {
 public:
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  Residuals(SoilFitProblem& problem, std::vector<Free>& free,
            const std::function<void(int)>& progress)
      : problem_(problem), free_(free), progress_(progress) {
    for (const MeasuredWheel& wheel : problem.measured.wheels) {
      for (const auto* measured :
           {&wheel.drawbar_pull_n, &wheel.side_force_n, &wheel.torque_nm, &wheel.sinkage_m}) {
        count_ += measured->has_value() ? 1 : 0;
      }
    }
    for (const MeasuredTransient& transient : problem.measured.transients)
      count_ += static_cast<int>(transient.places.size());
    count_ += static_cast<int>(problem.measured.plates.size());
  }

  int inputs() const { return static_cast<int>(free_.size()); }
  int values() const { return count_; }
  int evaluations() const { return evaluations_; }

  /// Gives the problem's free parameters these values.
  void set(const Eigen::VectorXd& variables) const {
    for (size_t i = 0; i < free_.size(); ++i) {
      *free_[i].value = free_[i].bounded.value(variables[static_cast<Eigen::Index>(i)]);
    }
  }

  int operator()(const Eigen::VectorXd& variables, Eigen::VectorXd& residuals) const {
    set(variables);
    if (progress_) progress_(++evaluations_);
    Eigen::Index next = 0;
    const auto add = [&](const std::optional<double>& measured, double predicted, double error) {
      if (measured.has_value()) residuals[next++] = (predicted - *measured) / error;
    };
    for (const MeasuredWheel& row : problem_.measured.wheels) {
      const WheelReaction r = predicted_wheel(row.wheel, problem_.soil, problem_.rim);
      const double load = row.wheel.load_n;
      add(row.drawbar_pull_n, r.drawbar_pull_n,
          error_of_force(row.drawbar_pull_n.value_or(0), load));
      add(row.side_force_n, r.side_force_n, error_of_force(row.side_force_n.value_or(0), load));
      add(row.torque_nm, r.torque_nm,
          error_of_force(row.torque_nm.value_or(0), load * row.wheel.radius_m));
      add(row.sinkage_m, r.sinkage_m, kShareOfValue * row.sinkage_m.value_or(0));
    }
    for (const MeasuredTransient& transient : problem_.measured.transients) {
      const std::vector<double> extra = predicted_transient(transient, problem_.soil, problem_.rim);
      for (size_t i = 0; i < extra.size(); ++i) {
        const MeasuredTransient::Place& place = transient.places[i];
        residuals[next++] = (extra[i] - place.extra_sinkage_m) /
                            portable::hypot(kShareOfValue * place.extra_sinkage_m,
                                            std::max(place.error_m, kMinError_m));
      }
    }
    for (const MeasuredPlate& row : problem_.measured.plates) {
      PlateTest plate;
      plate.soil = problem_.soil;
      plate.round = row.round;
      plate.length_m = row.length_m;
      plate.width_m = row.width_m;
      add(row.pressure_pa, bekker_pressure(plate, row.depth_m), kShareOfValue * row.pressure_pa);
    }
    return 0;
  }

  int df(const Eigen::VectorXd& variables, Eigen::MatrixXd& jacobian) const {
    Eigen::VectorXd moved = variables;
    Eigen::VectorXd up(count_);
    Eigen::VectorXd down(count_);
    for (Eigen::Index i = 0; i < variables.size(); ++i) {
      moved[i] = variables[i] + kDifference;
      (*this)(moved, up);
      moved[i] = variables[i] - kDifference;
      (*this)(moved, down);
      moved[i] = variables[i];
      jacobian.col(i) = (up - down) / (2.0 * kDifference);
    }
    return 0;
  }

 private:
  SoilFitProblem& problem_;
  std::vector<Free>& free_;
  const std::function<void(int)>& progress_;
  int count_ = 0;
  mutable int evaluations_ = 0;
};

std::vector<Free> free_parameters(SoilFitProblem& problem) {
  std::vector<Free> free;
  for (const std::string& key : problem.free) {
    if (std::any_of(free.begin(), free.end(), [&](const Free& f) { return f.key == key; }))
      throw InputError("fit: " + key + " is named twice");
    if (key == "rim_friction") {
      if (!std::isfinite(problem.rim.friction)) problem.rim.friction = 0.5;
      free.push_back({key, &problem.rim.friction, {0.0, 2.0}, problem.rim.friction});
      continue;
    }
    if (key == "rim_adhesion") {
      free.push_back({key, &problem.rim.adhesion_pa, {0.0, 1e5}, problem.rim.adhesion_pa});
      continue;
    }
    const auto* const row =
        std::find_if(std::begin(kSoilParameters), std::end(kSoilParameters),
                     [&](const SoilParameterInfo& info) { return key == info.key; });
    if (row == std::end(kSoilParameters)) {
      std::string what = "fit: unknown parameter '";
      what.append(key).append("'; known are rim_friction, rim_adhesion");
      for (const SoilParameterInfo& info : kSoilParameters) what.append(", ").append(info.key);
      throw InputError(what);
    }
    double& value = problem.soil.*(row->member);
    free.push_back({key, &value, {row->min, row->max}, value});
  }
  if (free.empty()) throw InputError("fit: no parameter is free; name one or several");
  return free;
}

struct Minimum {
  Eigen::VectorXd variables;
  double spread;
};

/// Root of the mean square of the residuals; infinite where they are no numbers.
double spread_at(const Residuals& residuals, const Eigen::VectorXd& variables) {
  Eigen::VectorXd left(residuals.values());
  residuals(variables, left);
  const double spread = std::sqrt(left.squaredNorm() / residuals.values());
  return std::isnan(spread) ? std::numeric_limits<double>::infinity() : spread;
}

void sort_by_spread(std::vector<Minimum>& places) {
  std::stable_sort(places.begin(), places.end(), [](const Minimum& one, const Minimum& other) {
    return one.spread < other.spread;
  });
}

bool as_good(const Minimum& one, const Minimum& best) {
  return one.spread <= 1.001 * best.spread + 1e-6;
}

/// Where the fit ends from the given start, and from the best of many places drawn from the whole
/// ranges: the answer, then all of them, best first. What is not determined stays as given where
/// the given start is as good as any.
std::vector<Minimum> minima_from_all_starts(Residuals& residuals, const std::vector<Free>& free,
                                            const Starts& other) {
  WorldRandom random(1, "starts of a soil fit");
  std::vector<Minimum> starts;
  const auto add = [&](const auto& variable_of) {
    Eigen::VectorXd variables(residuals.inputs());
    for (size_t i = 0; i < free.size(); ++i)
      variables[static_cast<Eigen::Index>(i)] = variable_of(free[i]);
    starts.push_back({variables, spread_at(residuals, variables)});
  };
  for (int i = 0; i < other.places; ++i) {
    add([&](const Free& /*one*/) { return random.uniform(-kMaxDrawn, kMaxDrawn); });
  }
  sort_by_spread(starts);
  starts.resize(other.best);
  add([](const Free& one) { return one.bounded.variable(one.start); });
  for (Minimum& minimum : starts) {
    Eigen::LevenbergMarquardt<Residuals> method(residuals);
    method.parameters.ftol = method.parameters.xtol = 1e-7;
    method.parameters.maxfev = 300;
    method.minimize(minimum.variables);
    minimum.spread = spread_at(residuals, minimum.variables);
  }
  const Minimum from_given = starts.back();
  sort_by_spread(starts);
  starts.insert(starts.begin(), as_good(from_given, starts.front()) ? from_given : starts.front());
  return starts;
}

/// Whether minima that are as good as the first one lie apart in this variable, by a twentieth of
/// its range.
bool differs(const std::vector<Minimum>& minima, Eigen::Index variable) {
  const auto place = [&](const Minimum& of) { return portable::sin(of.variables[variable]); };
  return std::any_of(minima.begin(), minima.end(), [&](const Minimum& other) {
    return as_good(other, minima.front()) && std::abs(place(other) - place(minima.front())) > 0.1;
  });
}

/// Whether the given value fits exactly as well. To the last digit it is no variable's.
bool changes_nothing(const Residuals& residuals, Eigen::VectorXd variables, Eigen::Index index,
                     const Free& one) {
  const double spread = spread_at(residuals, variables);
  variables[index] = one.bounded.variable(one.start);
  return spread_at(residuals, variables) == spread;
}

/// From this error on, of a range of -pi/2..pi/2, a variable is not determined.
constexpr double kMaxError = 1.0;

/// Standard errors of the variables. A direction in which nothing changes has an endless one.
Eigen::VectorXd errors_of(const Eigen::MatrixXd& jacobian, double variance) {
  constexpr double kNothing = 1e-6;  // of the change along the direction that changes most
  const Eigen::VectorXd size = jacobian.colwise().norm().transpose();
  Eigen::VectorXd scale = size;
  for (double& one : scale) one = one > 0.0 ? 1.0 / one : 1.0;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian * scale.asDiagonal(), Eigen::ComputeThinV);
  const double greatest = svd.singularValues()[0];
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(size.size());
  for (Eigen::Index i = 0; i < size.size(); ++i) {
    const double singular = svd.singularValues()[i];
    const Eigen::VectorXd share = svd.matrixV().col(i).array().square();
    if (singular > kNothing * greatest) {
      squares += variance / (singular * singular) * share;
    } else {
      for (Eigen::Index k = 0; k < size.size(); ++k) {
        if (share[k] > kNothing) squares[k] = std::numeric_limits<double>::infinity();
      }
    }
  }
  return squares.cwiseSqrt().cwiseProduct(scale);
}

}  // namespace

WheelReaction predicted_wheel(const RollingWheel& wheel, const SoilParameters& soil,
                              const RimSurface& rim) {
  RollingWheel rolling = wheel;
  rolling.friction = rim.friction;
  rolling.adhesion_pa = rim.adhesion_pa;
  return wheel_limit(rolling, soil, NormalStress::kRadial, AtAxle::kTakeForces);
}

std::vector<double> predicted_transient(const MeasuredTransient& transient,
                                        const SoilParameters& soil, const RimSurface& rim) {
  constexpr double kInterval_s = 0.02;
  WheelTest test;
  test.wheel = transient.wheel;
  test.wheel.friction = rim.friction;
  test.wheel.adhesion_pa = rim.adhesion_pa;
  test.soil = soil;
  test.mass_kg = kMovingMass_kg;
  test.cell_m = kCell_m;
  test.step_s = kStep_s;
  return transient.extra_sinkage_m(run_wheel(test, transient.schedule(), kInterval_s).samples);
}

SoilFit fit_soil(const SoilFitProblem& given, const std::function<void(int)>& progress) {
  SoilFitProblem problem = given;
  check_soil(problem.soil);
  std::vector<Free> free = free_parameters(problem);
  Residuals residuals(problem, free, progress);
  if (residuals.values() <= residuals.inputs()) {
    throw InputError("fit: " + std::to_string(residuals.values()) + " measurements for " +
                     std::to_string(residuals.inputs()) + " parameters; more are needed");
  }
  const std::vector<Minimum> minima = minima_from_all_starts(
      residuals, free,
      problem.measured.wheels.empty() && problem.measured.transients.empty() ? kPlateStarts
                                                                             : kWheelStarts);
  const Eigen::VectorXd& variables = minima.front().variables;

  SoilFit fit;
  fit.spread = minima.front().spread;
  for (size_t i = 1; i < minima.size(); ++i) fit.spreads.push_back(minima[i].spread);
  Eigen::MatrixXd jacobian(residuals.values(), residuals.inputs());
  residuals.df(variables, jacobian);
  std::vector<bool> idle;  // stay as given
  for (size_t i = 0; i < free.size(); ++i)
    idle.push_back(changes_nothing(residuals, variables, static_cast<Eigen::Index>(i), free[i]));
  residuals.set(variables);
  fit.residuals = residuals.values();
  fit.evaluations = residuals.evaluations();
  const double freedom = residuals.values() - residuals.inputs();
  const double variance = fit.spread * fit.spread * residuals.values() / freedom;
  const Eigen::VectorXd errors = errors_of(jacobian, variance);
  for (size_t i = 0; i < free.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const double variable = variables[index];
    const double error = errors[index];
    const Free& one = free[i];
    if (idle[i]) *one.value = one.start;
    const bool determined = error < kMaxError && !differs(minima, index);
    FittedParameter parameter{one.key,   one.start, *one.value, 0.0, one.bounded.at_bound(variable),
                              determined};
    parameter.standard_error = parameter.at_bound || !parameter.determined
                                   ? std::numeric_limits<double>::quiet_NaN()
                                   : error * std::abs(one.bounded.slope(variable));
    fit.parameters.push_back(parameter);
  }
  fit.soil = problem.soil;
  fit.rim = problem.rim;
  return fit;
}

}  // namespace screed
