// A fit to wheels finds the parameters that made the figures.
// Long: the limit of a wheel takes milliseconds, and a fit from four places asks for thousands.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "host_sim/soil_validation/soil_fit.h"
#include "paths.h"

namespace screed {
namespace {

TEST(SoilFitTest, FindsWhatMadeTheFigures) {
  SoilFitProblem problem;
  problem.soil = soil_preset("cmu_2022");
  problem.rim = {0.397, 0.0};
  problem.measured = read_soil_measurements(
      std::string(kDataFolder) + "/soil/single_wheel_cmu2022.csv", "cmu2022_smooth_0_");
  std::vector<MeasuredWheel>& wheels = problem.measured.wheels;
  for (size_t i = 1; i < wheels.size();) {  // one of each slip
    if (std::abs(wheels[i].wheel.slip - wheels[i - 1].wheel.slip) < 0.05)
      wheels.erase(wheels.begin() + static_cast<std::ptrdiff_t>(i));
    else
      ++i;
  }
  for (MeasuredWheel& row : problem.measured.wheels) {
    const WheelReaction r = predicted_wheel(row.wheel, problem.soil, problem.rim);
    row.drawbar_pull_n = r.drawbar_pull_n;
    row.sinkage_m = r.sinkage_m;
    row.side_force_n.reset();
  }
  problem.free = {"slip_bearing", "K", "rim_friction"};
  problem.soil.slip_bearing = 0.6;
  problem.soil.shear_modulus_m = 0.02;
  problem.rim.friction = 0.5;
  const SoilFit fit = fit_soil(problem);
  EXPECT_NEAR(fit.soil.slip_bearing, soil_preset("cmu_2022").slip_bearing, 1e-3);
  EXPECT_NEAR(fit.soil.shear_modulus_m, soil_preset("cmu_2022").shear_modulus_m, 1e-4);
  EXPECT_NEAR(fit.rim.friction, 0.397, 1e-3);
  EXPECT_LT(fit.spread, 0.01);
  for (const FittedParameter& p : fit.parameters) EXPECT_LT(p.standard_error, 1e-3) << p.key;
}

}  // namespace
}  // namespace screed
