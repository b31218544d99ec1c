// Bekker's z^n as a table: the power is asked for a thousand times a step.
#pragma once

#include <cmath>
#include <vector>

namespace screed {

/// z^n for 0 <= z <= 0.256 m by linear interpolation between steps of 62.5 um; beyond it the
/// tangent goes on. Relative error below 2e-4 from 1 mm on for n >= 0.5.
class PressureTable {
 public:
  PressureTable() = default;
  explicit PressureTable(double exponent) { set_exponent(exponent); }

  /// Tabulates another exponent. Allocates only the first time.
  void set_exponent(double exponent) {
    exponent_ = exponent;
    power_.resize(kSteps + 2);
    for (int i = 0; i < kSteps + 2; ++i)
      power_[static_cast<size_t>(i)] = std::pow(i / kPerMetre, exponent);
  }

  double exponent() const { return exponent_; }
  double power(double z) const {
    const double at = z * kPerMetre;
    const int i = at < kSteps ? static_cast<int>(at) : kSteps;
    const double low = power_[static_cast<size_t>(i)];
    return low + (at - i) * (power_[static_cast<size_t>(i) + 1] - low);
  }

 private:
  static constexpr double kPerMetre = 16000.0;
  static constexpr int kSteps = 4096;

  double exponent_ = 1.0;
  std::vector<double> power_;
};

}  // namespace screed
