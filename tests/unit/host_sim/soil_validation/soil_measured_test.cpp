// Wheels on soil against single-wheel tests: limit and engine, with one set of parameters a soil.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "host_sim/core/errors.h"
#include "host_sim/soil_validation/plate_press.h"
#include "host_sim/soil_validation/soil_fit.h"
#include "host_sim/soil_validation/wheel_testbed.h"
#include "paths.h"

namespace screed {
namespace {

std::vector<MeasuredWheel> rows(const char* file, const char* prefix) {
  return read_soil_measurements(std::string(kDataFolder) + "/soil/" + file, prefix).wheels;
}

struct Errors {
  double pull = 0.0;  // mean, over the load
  double side = 0.0;
  double sinkage = 0.0;  // mean, relative
};

Errors mean_errors(const std::vector<MeasuredWheel>& measured, double low, double high,
                   const std::function<WheelReaction(const MeasuredWheel&)>& predicted) {
  Errors sum;
  int count = 0;
  for (const MeasuredWheel& row : measured) {
    if (row.wheel.slip < low || row.wheel.slip > high) continue;
    const WheelReaction r = predicted(row);
    sum.pull += std::abs(r.drawbar_pull_n - *row.drawbar_pull_n) / row.wheel.load_n;
    if (row.side_force_n)
      sum.side += std::abs(r.side_force_n - *row.side_force_n) / row.wheel.load_n;
    sum.sinkage += std::abs(r.sinkage_m / *row.sinkage_m - 1.0);
    ++count;
  }
  return {sum.pull / count, sum.side / count, sum.sinkage / count};
}

const RimSurface kDingsRim{0.479, 0.0};
const RimSurface kCmuRim{0.325, 0.0};

// Required: slip 0.1 to 0.6, mean error of the pull 0.05 of the load, of the sinkage 20 %.
TEST(SoilMeasuredTest, DingsSmoothWheel) {
  const SoilParameters soil = soil_preset("ding_2011");
  const auto engine = [&](const MeasuredWheel& row) {
    WheelTest test;
    test.wheel = row.wheel;
    test.wheel.friction = kDingsRim.friction;
    test.soil = soil;
    test.mass_kg = 8.0;
    test.cell_m = 0.01;
    test.duration_s = 10.0;
    const WheelPass pass = run_wheel(test).passes[0];
    WheelReaction reaction;
    reaction.drawbar_pull_n = pass.drawbar_pull_n;
    reaction.sinkage_m = pass.sinkage_m;
    return reaction;
  };
  const Errors errors =
      mean_errors(rows("single_wheel_ding2011.csv", "ding2011_smooth"), 0.05, 0.7, engine);
  EXPECT_LT(errors.pull, 0.03);
  EXPECT_LT(errors.sinkage, 0.08);
}

// Required: slip angle 0, slip -0.2 to 0.9: pull 0.05, sinkage 15 %; slip angle 15: pull 0.07, side
// force 0.10; dragged: pull within 0.3 at any slip down to -1. The parameters were fitted at slip
// angle 0 alone.
TEST(SoilMeasuredTest, TheLimitIsCmusSmoothWheel) {
  const SoilParameters soil = soil_preset("cmu_2022");
  const auto limit = [&](const MeasuredWheel& row) {
    return predicted_wheel(row.wheel, soil, kCmuRim);
  };
  const auto straight = rows("single_wheel_cmu2022.csv", "cmu2022_smooth_0_");
  const auto angled = rows("single_wheel_cmu2022.csv", "cmu2022_smooth_15_");
  ASSERT_EQ(straight.size() + angled.size(), 54U);
  const Errors ahead = mean_errors(straight, -0.25, 0.95, limit);
  EXPECT_LT(ahead.pull, 0.03);
  EXPECT_LT(ahead.sinkage, 0.10);
  const Errors aside = mean_errors(angled, -0.25, 0.95, limit);
  EXPECT_LT(aside.pull, 0.05);
  EXPECT_LT(aside.side, 0.08);
  for (const MeasuredWheel& row : straight) {
    if (row.wheel.slip > -0.4) continue;
    EXPECT_NEAR(limit(row).drawbar_pull_n, *row.drawbar_pull_n, 0.3 * row.wheel.load_n) << row.name;
  }
}

/// Of CMU's smooth wheel straight ahead the first trial of each slip.
std::vector<MeasuredWheel> one_trial_of_each_slip() {
  std::vector<MeasuredWheel> first;
  for (const MeasuredWheel& row : rows("single_wheel_cmu2022.csv", "cmu2022_smooth_0_")) {
    const bool again = !first.empty() && std::abs(first.back().wheel.slip - row.wheel.slip) < 0.05;
    if (!again) first.push_back(row);
  }
  return first;
}

// The engine, at one trial of each slip; required as of the limit.
TEST(SoilMeasuredTest, TheEngineIsCmusSmoothWheel) {
  const auto engine = [&](const MeasuredWheel& row) {
    WheelTest test;
    test.wheel = row.wheel;
    test.wheel.friction = kCmuRim.friction;
    test.soil = soil_preset("cmu_2022");
    test.mass_kg = 2.0;
    test.speed_m_per_s = 0.05;
    test.step_s = 0.002;
    test.duration_s = 16.0;
    const WheelPass pass = run_wheel(test).passes[0];
    WheelReaction reaction;
    reaction.drawbar_pull_n = pass.drawbar_pull_n;
    reaction.side_force_n = pass.side_force_n;
    reaction.sinkage_m = pass.sinkage_m;
    return reaction;
  };
  const std::vector<MeasuredWheel> first = one_trial_of_each_slip();
  ASSERT_EQ(first.size(), 9U);
  const Errors ahead = mean_errors(first, -0.25, 0.95, engine);
  EXPECT_LT(ahead.pull, 0.04);
  EXPECT_LT(ahead.sinkage, 0.12);
  for (const MeasuredWheel& row : first) {
    if (row.wheel.slip > -0.4) continue;
    EXPECT_LT(mean_errors({row}, -1.0, -0.4, engine).pull, 0.3) << row.name;
  }
}

// What the wheel sinks in addition as its rim goes over from 10 to 20, 40 and 100 mm/s: each value
// within 20 % or 1 mm of what was measured, with the parameters that keep the tests above.
TEST(SoilMeasuredTest, TheEngineSinksBySlipAsCmusSmoothWheel) {
  const auto measured =
      read_soil_measurements(std::string(kDataFolder) + "/soil/slip_transients_cmu2022.csv", "cmu")
          .transients;
  ASSERT_EQ(measured.size(), 3U);
  for (const MeasuredTransient& transient : measured) {
    const std::vector<double> extra =
        predicted_transient(transient, soil_preset("cmu_2022"), kCmuRim);
    ASSERT_EQ(extra.size(), transient.places.size());
    for (size_t i = 0; i < extra.size(); ++i) {
      const double wanted = transient.places[i].extra_sinkage_m;
      EXPECT_NEAR(extra[i], wanted, std::max(0.001, 0.2 * wanted))
          << transient.name << ", slip path " << transient.places[i].slip_path_m;
    }
  }
}

TEST(SoilFitTest, FitsPlates) {
  SoilFitProblem problem;
  problem.soil = soil_preset("lete_sand");
  const double widths[] = {0.05, 0.1};
  for (const double width : widths) {
    for (const double depth : {0.002, 0.005, 0.01, 0.02}) {
      const double pressure = (3e6 + 50e3 / width) * std::pow(depth, 1.2);
      problem.measured.plates.push_back({"plate", width, 2.0 * width, false, depth, pressure});
    }
  }
  problem.free = {"k_phi", "k_c", "n"};
  const SoilFit fit = fit_soil(problem);
  EXPECT_NEAR(fit.soil.k_phi / 3e6, 1.0, 0.01);
  EXPECT_NEAR(fit.soil.k_c / 50e3, 1.0, 0.02);
  EXPECT_NEAR(fit.soil.exponent, 1.2, 0.002);
}

/// Bekker's law of this soil under plates, without errors.
std::vector<MeasuredPlate> plates_on(const SoilParameters& soil, std::vector<double> widths_m) {
  std::vector<MeasuredPlate> plates;
  for (const double width_m : widths_m) {
    for (const double depth_m : {0.002, 0.005, 0.01, 0.02, 0.04}) {
      PlateTest test;
      test.soil = soil;
      test.length_m = 4.0 * width_m;
      test.width_m = width_m;
      plates.push_back(
          {"plate", width_m, 4.0 * width_m, false, depth_m, bekker_pressure(test, depth_m)});
    }
  }
  return plates;
}

TEST(SoilFitTest, FindsEveryNamedSoilFromEveryOther) {
  for (const SoilPreset& wanted : soil_presets()) {
    for (const SoilPreset& start : soil_presets()) {
      SoilFitProblem problem;
      problem.soil = start.soil;
      problem.soil.elastic_pa_per_m = wanted.soil.elastic_pa_per_m;
      problem.measured.plates = plates_on(wanted.soil, {0.05, 0.1, 0.2});
      problem.free = {"k_phi", "k_c", "n"};
      const SoilFit fit = fit_soil(problem);
      const std::string where = wanted.soil.name + " from " + start.soil.name;
      EXPECT_LT(fit.spread, 1e-3) << where;
      EXPECT_NEAR(fit.soil.k_phi / wanted.soil.k_phi, 1.0, 0.01) << where;
      EXPECT_NEAR(fit.soil.k_c / wanted.soil.k_phi, wanted.soil.k_c / wanted.soil.k_phi, 0.001)
          << where;
      EXPECT_NEAR(fit.soil.exponent, wanted.soil.exponent, 0.002) << where;
      ASSERT_EQ(fit.spreads.size(), 12U);
      EXPECT_LE(fit.spreads.front(), fit.spread);
    }
  }
}

TEST(SoilFitTest, SaysWhatTheTestsDoNotDetermine) {
  const SoilParameters& sand = soil_preset("lete_sand");
  const auto determined = [&](std::vector<double> widths_m, std::vector<std::string> free) {
    SoilFitProblem problem;
    problem.soil = sand;
    problem.measured.plates = plates_on(sand, std::move(widths_m));
    for (size_t i = 0; i < problem.measured.plates.size(); ++i)  // errors of 1 %
      problem.measured.plates[i].pressure_pa *= i % 2 == 0 ? 1.01 : 0.99;
    problem.free = std::move(free);
    std::string keys;
    for (const FittedParameter& p : fit_soil(problem).parameters) {
      EXPECT_EQ(std::isnan(p.standard_error), !p.determined || p.at_bound) << p.key;
      if (p.determined) keys += p.key + " ";
    }
    return keys;
  };
  EXPECT_EQ(determined({0.05, 0.2}, {"k_c", "k_phi", "n"}), "k_c k_phi n ");
  // k_c / b + k_phi is one number where all plates have one width.
  EXPECT_EQ(determined({0.05}, {"k_c", "k_phi", "n"}), "n ");
  for (const char* key : {"K", "phi", "c", "repose", "slip_bearing", "compaction"})
    EXPECT_EQ(determined({0.05}, {key, "k_phi", "n"}), "k_phi n ") << key;
}

TEST(SoilFitTest, RefusesWhatMakesNoSense) {
  SoilFitProblem problem;
  problem.soil = soil_preset("viper");
  problem.measured.plates.push_back({"plate", 0.05, 0.05, false, 0.01, 1e4});
  const auto message = [&](std::vector<std::string> free) {
    problem.free = std::move(free);
    try {
      fit_soil(problem);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(message({}), "fit: no parameter is free; name one or several");
  EXPECT_EQ(message({"n", "n"}), "fit: n is named twice");
  EXPECT_EQ(message({"n"}), "fit: 1 measurements for 1 parameters; more are needed");
  EXPECT_NE(message({"spice"}).find("fit: unknown parameter 'spice'; known are rim_friction"),
            std::string::npos);
}

}  // namespace
}  // namespace screed
