// Traps that an experiment cuts into its terrain.
#include "host_sim/run/world/placement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/core/errors.h"
#include "host_sim/run/simulation/simulation.h"

namespace screed {
namespace {

/// Level ground with a trap; the start 0.2 m east of the middle, heading north.
HeightField with_trap(const char* kind, double distance_m, double size) {
  Experiment experiment;
  experiment.vehicle.x_m = 0.2;
  experiment.vehicle.heading_deg = 90.0;
  experiment.trap.kind = kind;
  experiment.trap.distance_m = distance_m;
  experiment.trap.size = size;
  HeightField field = HeightField::flat(4.0, 0.01);
  set_trap(experiment, field);
  return field;
}

double height(const HeightField& field, double x, double y) {
  return field.at(x, y).height;
}

TEST(Trap, NoneChangesNothing) {
  EXPECT_EQ(with_trap("none", 0.5, 0.1).height_sum(), 0);
  EXPECT_EQ(trap_kinds().front(), "none");
}

TEST(Trap, AWallStandsAllRoundTheStart) {
  const HeightField field = with_trap("wall", 0.5, 0.15);
  EXPECT_NEAR(height(field, 0.2, 0.0), 0.0, 1e-6);
  EXPECT_NEAR(height(field, 0.2, 0.48), 0.0, 1e-6);
  for (const double turn : {0.0, 1.0, 2.0, 4.0}) {
    EXPECT_NEAR(height(field, 0.2 + 0.55 * std::cos(turn), 0.55 * std::sin(turn)), 0.15, 1e-6);
  }
}

TEST(Trap, ASlopeRisesByItsAngleAndEnds) {
  const HeightField field = with_trap("slope", 0.4, 30.0);
  EXPECT_NEAR(height(field, 0.2, 0.9) - height(field, 0.2, 0.8), 0.1 * std::tan(0.5235988), 1e-4);
  EXPECT_NEAR(height(field, 0.2, 1.8), height(field, 0.2, 1.7), 1e-6);
}

TEST(Trap, HumpAndRutsLieAheadUnderTheRobot) {
  const HeightField hump = with_trap("hump", 0.3, 0.06);
  EXPECT_NEAR(height(hump, 0.2, 0.5), 0.06, 1e-6);
  EXPECT_NEAR(height(hump, 0.3, 0.5), 0.0, 1e-6);
  EXPECT_NEAR(height(hump, 0.5, 0.0), 0.0, 1e-6);
  const HeightField ruts = with_trap("ruts", -0.25, 0.05);
  EXPECT_NEAR(height(ruts, 0.2, 0.0), 0.0, 1e-6);
  EXPECT_NEAR(height(ruts, 0.2 + 0.0975, 0.0), -0.05, 1e-6);
  EXPECT_NEAR(height(ruts, 0.2 - 0.0975, 0.2), -0.05, 1e-6);
  EXPECT_NEAR(height(ruts, 0.2 - 0.0975, 0.4), 0.0, 1e-6);
}

TEST(Trap, TheTerrainOfAnExperimentHasIt) {
  Experiment experiment;
  experiment.trap.kind = "trench";
  experiment.trap.distance_m = 0.4;
  experiment.trap.size = 0.07;
  EXPECT_NEAR(height(make_terrain(experiment), 0.58, 0.0), -0.07, 0.01);
}

}  // namespace
}  // namespace screed
