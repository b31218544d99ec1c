// Levenberg and Marquardt's method (Eigen's, after MINPACK) over parameters that a sine keeps
// inside their bounds.
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
#include "host_sim/soil_validation/plate_press.h"

namespace screed {
namespace {

constexpr double kForceShareOfLoad = 0.03;
constexpr double kShareOfValue = 0.10;
constexpr double kDifference =
    1e-5;  // of a free variable, for derivatives: above the limit's noise
// Of the distance between the bounds: nearer than that, a parameter lies at its bound.
constexpr double kAtBound = 1e-3;

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
    count_ += static_cast<int>(problem.measured.plates.size());
  }

  int inputs() const { return static_cast<int>(free_.size()); }
  int values() const { return count_; }
  int evaluations() const { return evaluations_; }

  int operator()(const Eigen::VectorXd& variables, Eigen::VectorXd& residuals) const {
    for (size_t i = 0; i < free_.size(); ++i) {
      *free_[i].value = free_[i].bounded.value(variables[static_cast<Eigen::Index>(i)]);
    }
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

}  // namespace

WheelReaction predicted_wheel(const RollingWheel& wheel, const SoilParameters& soil,
                              const RimSurface& rim) {
  RollingWheel rolling = wheel;
  rolling.friction = rim.friction;
  rolling.adhesion_pa = rim.adhesion_pa;
  return wheel_limit(rolling, soil, NormalStress::kRadial, AtAxle::kTakeForces);
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
  Eigen::VectorXd variables(residuals.inputs());
  for (size_t i = 0; i < free.size(); ++i) {
    variables[static_cast<Eigen::Index>(i)] = free[i].bounded.variable(*free[i].value);
  }
  Eigen::LevenbergMarquardt<Residuals> method(residuals);
  method.parameters.ftol = method.parameters.xtol = 1e-7;
  method.parameters.maxfev = 300;
  method.minimize(variables);

  SoilFit fit;
  Eigen::VectorXd left(residuals.values());
  Eigen::MatrixXd jacobian(residuals.values(), residuals.inputs());
  residuals.df(variables, jacobian);
  residuals(variables, left);
  fit.residuals = residuals.values();
  const double freedom = residuals.values() - residuals.inputs();
  const double variance = left.squaredNorm() / freedom;
  fit.spread = std::sqrt(left.squaredNorm() / residuals.values());
  fit.evaluations = residuals.evaluations();
  const Eigen::MatrixXd covariance =
      variance *
      (jacobian.transpose() * jacobian).completeOrthogonalDecomposition().pseudoInverse();
  for (size_t i = 0; i < free.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const Free& one = free[i];
    FittedParameter parameter{one.key, one.start, *one.value, 0.0,
                              one.bounded.at_bound(variables[index])};
    parameter.standard_error =
        parameter.at_bound
            ? std::numeric_limits<double>::quiet_NaN()
            : std::sqrt(covariance(index, index)) * std::abs(one.bounded.slope(variables[index]));
    fit.parameters.push_back(parameter);
  }
  fit.soil = problem.soil;
  fit.rim = problem.rim;
  return fit;
}

}  // namespace screed
