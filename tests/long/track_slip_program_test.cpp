// The slip of both tracks that `screed decode` computes from a robot's telemetry, against that of
// the simulated robot on loose ground.
// Long: whole runs on loose ground.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "host_sim/run/session/session_reader.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

constexpr double kTread_m = 0.195;
constexpr double kTick_s = 0.01;
constexpr std::size_t kWindow = 50;  // ticks: half a second, as TrackSlipEstimate

struct Errors {
  double estimate = 0.0;  ///< mean, absolute
  double no_slip = 0.0;   ///< of assuming none
  int rows = 0;

  void add(double estimated, double travel_m, double track_m) {
    const double truth = std::clamp(1.0 - travel_m / track_m, -1.0, 1.5);
    estimate += std::abs(estimated - truth);
    no_slip += std::abs(truth);
    ++rows;
  }
};

class TrackSlipProgram : public Program {};

TEST_F(TrackSlipProgram, OnLooseGroundItIsNearerToTheTruthThanNoSlip) {
  ASSERT_EQ(run("sim soft_bed --duration 180 --quiet --no-pictures --out run").exit_code, 0);
  ASSERT_EQ(run("decode run/telemetry.log --csv --out tables").exit_code, 0);
  const SessionReader session(root_ / "run/session.h5");
  std::vector<SimFrame> frames(session.frames());
  session.read(0, std::span(frames));

  Errors errors;
  std::ifstream table(root_ / "tables/track_slip.csv");
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    double time_s = 0.0;
    double left = 0.0;
    double right = 0.0;
    if (std::sscanf(line.c_str(), "%lf,1,%lf,%lf", &time_s, &left, &right) != 3) continue;
    const auto end = static_cast<std::size_t>(std::lround(time_s / kTick_s));
    if (end < kWindow || end > frames.size()) continue;
    double chassis_m = 0.0;
    double track_m[2] = {};
    double turn_rad = 0.0;
    for (std::size_t i = end - kWindow; i < end; ++i) {
      chassis_m += frames[i].velocity_x * kTick_s;
      track_m[0] += frames[i].track_left * kTick_s;
      track_m[1] += frames[i].track_right * kTick_s;
      turn_rad += frames[i].rate_z * kTick_s;
    }
    if (std::min(std::abs(track_m[0]), std::abs(track_m[1])) < 0.025) continue;
    errors.add(left, chassis_m - turn_rad * kTread_m / 2.0, track_m[0]);
    errors.add(right, chassis_m + turn_rad * kTread_m / 2.0, track_m[1]);
  }
  ASSERT_GT(errors.rows, 200);
  errors.estimate /= errors.rows;
  errors.no_slip /= errors.rows;
  std::printf("mean error of slip %.3f; of assuming none %.3f; %d values\n", errors.estimate,
              errors.no_slip, errors.rows);
  EXPECT_LT(errors.estimate, 0.85 * errors.no_slip);
}

}  // namespace
}  // namespace screed::testing
