// The path that a soil bed remembers of a footprint: how far it came and how steeply, in closed
// form.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "host_sim/physics/soil/sinking.h"
#include "host_sim/physics/soil/soil_bed.h"

namespace screed {
namespace {

constexpr double kRadius_m = 0.06;  // of a wheel: its L
constexpr double kWidth_m = 0.05;
constexpr double kStep_s = 0.001;

/// A wheel in the soil that is moved as the test wants.
class MovedWheel {
 public:
  explicit MovedWheel(const SoilOptions& options = {},
                      const Footprint& shape = Footprint::wheel(kRadius_m, kWidth_m))
      : bed_(HeightField(61, 61, 0.005, true), soil_preset("lete_sand"), options), wheel_(shape) {
    pose.translation().z() = kRadius_m - 0.02;
  }
  void move(const Eigen::Vector3d& velocity, int steps = 1) {
    FootprintMotion motion;
    motion.mass_kg = std::numeric_limits<double>::infinity();
    motion.velocity = velocity;
    motion.omega = omega;
    for (int i = 0; i < steps; ++i) {
      wheel_.set_pose(pose);
      reaction = bed_.press(wheel_, motion, kStep_s, memory);
      bed_.end_step();
    }
  }
  const PathHistory& path() const { return memory.path; }

  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();  ///< as the soil is told
  ContactMemory memory;
  TerrainReaction reaction;

 private:
  SoilBed bed_;
  Footprint wheel_;
};

/// The mean gradient after so many steps of one gradient, each of this length.
double mean_gradient(double gradient, double step_m, int steps) {
  return gradient * (1.0 - std::pow(1.0 - std::abs(step_m) / kRadius_m, steps));
}

TEST(SoilPath, GrowsWithTheWayAndItsGradientFollowsOverTheBodysLength) {
  for (const double speed : {0.5, -0.5}) {
    for (const double rise : {0.1, -0.15}) {
      MovedWheel wheel;
      wheel.move({speed, 0.0, rise}, 30);
      EXPECT_NEAR(wheel.path().travel_m, speed * 30 * kStep_s, 1e-12);
      EXPECT_NEAR(wheel.path().gradient, mean_gradient(rise / speed, speed * kStep_s, 30), 1e-9)
          << speed << " " << rise;
    }
  }
}

TEST(SoilPath, WhatMovesSidewaysComesAlongNothing) {
  MovedWheel wheel;
  wheel.move({0.0, 0.4, -0.1}, 10);
  EXPECT_EQ(wheel.path().travel_m, 0.0);
  EXPECT_EQ(wheel.path().gradient, 0.0);
}

TEST(SoilPath, IsInTheBodysAxes) {
  MovedWheel wheel;
  wheel.pose.linear() = (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                         Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitY()) *
                         Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()))
                            .toRotationMatrix();
  const Eigen::Vector3d local(0.5, 0.2, 0.1);
  wheel.move(wheel.pose.linear() * local, 20);
  EXPECT_NEAR(wheel.path().travel_m, 0.5 * 20 * kStep_s, 1e-12);
  EXPECT_NEAR(wheel.path().gradient, mean_gradient(0.2, 0.5 * kStep_s, 20), 1e-9);
}

TEST(SoilPath, BeginsAnewWhereTheBodyTurnsBack) {
  MovedWheel wheel;
  wheel.move({0.5, 0.0, 0.1}, 30);
  // A millimetre back is trembling.
  wheel.move({-0.5, 0.0, 0.1}, 2);
  EXPECT_NEAR(wheel.path().travel_m, 30 * 0.5 * kStep_s, 1e-12);
  wheel.move({0.5, 0.0, 0.1}, 2);
  EXPECT_NEAR(wheel.path().travel_m, 30 * 0.5 * kStep_s, 1e-12);
  wheel.move({-0.5, 0.0, 0.1}, 3);
  EXPECT_NEAR(wheel.path().travel_m, -0.5 * kStep_s, 1e-12);
  EXPECT_NEAR(wheel.path().gradient, mean_gradient(-0.2, 0.5 * kStep_s, 1), 1e-9);
  // Standing still does not end it.
  wheel.move({0.0, 0.0, 0.0}, 5);
  EXPECT_NEAR(wheel.path().travel_m, -0.5 * kStep_s, 1e-12);
}

TEST(SoilPath, WhatDropsHasNotDrivenThere) {
  for (const double rise : {3.0, -3.0}) {
    MovedWheel wheel;
    wheel.move({0.2, 0.0, rise}, 4);
    EXPECT_NEAR(wheel.path().gradient, mean_gradient(rise > 0.0 ? 1.0 : -1.0, 0.2 * kStep_s, 4),
                1e-9);
  }
  MovedWheel wheel;
  wheel.move({0.5, 0.0, 0.1}, 30);
  wheel.move({70.0, 0.0, 7.0});  // farther than it is long
  EXPECT_EQ(wheel.path().gradient, 0.0);
  MovedWheel quick;
  quick.move({42.0, 0.0, 4.2});  // seven tenths of its length
  EXPECT_NEAR(quick.path().gradient, 0.07, 1e-9);
}

TEST(SoilPath, WithoutFollowingSlopesItIsLevel) {
  SoilOptions options;
  options.follow_slopes = false;
  MovedWheel wheel(options);
  wheel.pose.linear() = (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                         Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitY()) *
                         Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()))
                            .toRotationMatrix();
  wheel.move({0.3, 0.1, 0.2}, 3);
  MovedWheel pitched(options);
  pitched.pose.linear() = Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pitched.move({0.3, 0.1, 0.2}, 3);
  EXPECT_NEAR(pitched.path().gradient, -std::tan(0.3), 1e-12);
  // A displacement of (1, 0, gradient) in the body's axes does not rise.
  const Eigen::Vector3d along =
      wheel.pose.linear() * Eigen::Vector3d(1.0, 0.0, wheel.path().gradient);
  EXPECT_NEAR(along.z(), 0.0, 1e-12);
  EXPECT_GT(std::abs(wheel.path().gradient), 0.1);
}

TEST(SoilPath, IsNoLongerThanTheBody) {
  MovedWheel wheel;
  wheel.move({0.5, 0.0, 0.01}, 400);
  EXPECT_NEAR(wheel.path().travel_m, 2.0 * kRadius_m, 1e-12);
  wheel.move({-0.5, 0.0, 0.0}, 403);
  EXPECT_NEAR(wheel.path().travel_m, -2.0 * kRadius_m, 1e-12);
}

// Where it leaves the curve by half its width: s^2 = w R.
TEST(SoilPath, EndsWhereATurnLeavesIt) {
  for (const double rate : {-5.0, 5.0}) {
    MovedWheel wheel;
    wheel.move({0.5, 0.0, 0.01}, 400);
    wheel.omega.z() = rate;
    wheel.move({0.5, 0.0, 0.01});
    EXPECT_NEAR(wheel.path().travel_m, std::sqrt(kWidth_m * 0.5 / 5.0), 1e-12);
    wheel.move({0.0, 0.1, 0.0});  // turns on the spot
    EXPECT_EQ(wheel.path().travel_m, 0.0);
  }
}

// What has pitched by b lies in other axes than it came in: a straight path in its own is wrong by
// s b at s behind it. Of a pitch on the way, what came before it counts less and less.
TEST(SoilPath, EndsWhereABeltHasPitchedAgainstIt) {
  constexpr double kHalf_m = 0.05;
  constexpr double kLength_m = 2.0 * (kHalf_m + kRadius_m);
  for (const double rate : {-2.0, 2.0}) {
    MovedWheel belt({}, Footprint::track(kHalf_m, kRadius_m, kWidth_m));
    belt.move({0.5, 0.0, 0.0}, 600);
    ASSERT_NEAR(belt.path().travel_m, kLength_m, 1e-12);
    belt.omega.y() = rate;
    belt.move({0.0, 0.0, 0.0}, 10);  // rocks on the spot
    EXPECT_NEAR(belt.path().bend_rad, rate * 10 * kStep_s, 1e-12);
    EXPECT_NEAR(belt.path().travel_m, kPathError_m / 0.02, 1e-12);
    belt.omega.y() = 0.0;
    belt.move({0.5, 0.0, 0.0}, 3000);  // many times its length
    EXPECT_NEAR(belt.path().bend_rad, 0.0, 1e-5);
    EXPECT_NEAR(belt.path().travel_m, kLength_m, 1e-12);
  }
  MovedWheel wheel;  // is as round as before
  wheel.move({0.5, 0.0, 0.0}, 400);
  wheel.omega.y() = 2.0;
  wheel.move({0.0, 0.0, 0.0}, 10);
  EXPECT_NEAR(wheel.path().travel_m, 2.0 * kRadius_m, 1e-12);
}

// A wheel that has come up on its way stands on nothing until it has sunk by that: then the soil
// carries it as one that never moved.
TEST(SoilPath, WhatSinksOnTheSpotComesDownToIt) {
  constexpr double kGradient = 0.02;
  const double kFarEnd_m = kGradient * 2.0 * kRadius_m;  // lower than the wheel
  MovedWheel wheel;
  wheel.move({0.5, 0.0, kGradient * 0.5}, 2000);
  ASSERT_NEAR(wheel.path().gradient, kGradient, 1e-6);
  for (const double speed : {0.0, -0.001, 0.001}) {  // trembling, too
    MovedWheel sinking = wheel;
    sinking.move({speed, 0.0, -0.25 * kFarEnd_m / kStep_s});
    EXPECT_NEAR(sinking.path().gradient, 0.75 * kGradient, 0.002 * kGradient) << speed;
    sinking.move({0.0, 0.0, -0.5 * kFarEnd_m / kStep_s});
    EXPECT_NEAR(sinking.path().gradient, 0.25 * kGradient, 0.002 * kGradient) << speed;
    sinking.move({0.0, 0.0, -kFarEnd_m / kStep_s});
    EXPECT_EQ(sinking.path().gradient, 0.0) << speed;
    // What rises from there is no path.
    sinking.move({0.0, 0.0, 0.1}, 3);
    EXPECT_EQ(sinking.path().gradient, 0.0) << speed;
  }
}

TEST(SoilPath, IsForgottenWhereTheBodyLeavesTheGround) {
  MovedWheel wheel;
  wheel.move({0.5, 0.0, 0.1}, 30);
  wheel.pose.translation().z() = 1.0;
  wheel.move({0.5, 0.0, 0.1});
  EXPECT_EQ(wheel.path().travel_m, 0.0);
  EXPECT_EQ(wheel.memory.patch_b_m, 0.0);
  EXPECT_EQ(wheel.reaction.force, Eigen::Vector3d::Zero());
}

// ---- a bed's options

TEST(SoilBedOptions, CompactionTakesItsShareOfWhatSinks) {
  for (const double compaction : {0.0, 0.25, 1.0}) {
    SoilParameters soil = soil_preset("lete_sand");
    soil.compaction = compaction;
    soil.slip_layer_m = 0.0;
    SoilBed bed(HeightField(61, 61, 0.005, true), soil, {});
    Footprint plate = Footprint::box({0.1, 0.1, 0.02});
    FootprintMotion motion;
    motion.mass_kg = std::numeric_limits<double>::infinity();
    ContactMemory memory;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int i = 0; i <= 20; ++i) {
      pose.translation().z() = 0.01 - 0.0002 * i;
      plate.set_pose(pose);
      motion.velocity.z() = -0.2;
      bed.press(plate, motion, kStep_s, memory);
      bed.end_step();
    }
    int64_t sunk = 0;
    for (int iy = 0; iy < 61; ++iy) {
      for (int ix = 0; ix < 61; ++ix) sunk += std::max<int64_t>(0, -bed.surface().node(ix, iy));
    }
    ASSERT_GT(sunk, 1000);
    const VolumeBalance balance = bed.balance();
    EXPECT_EQ(balance.error(), 0);
    EXPECT_EQ(balance.in_transit, 0);
    EXPECT_NEAR(static_cast<double>(balance.compacted), compaction * static_cast<double>(sunk),
                2.0 + 0.001 * static_cast<double>(sunk));
  }
}

TEST(SoilBedOptions, WithoutAvalanchesASlopeStays) {
  HeightField steep(61, 61, 0.005, true);
  steep.set_node(30, 30, static_cast<Height>(std::lround(0.05 / kHeightUnit_m)));
  for (const bool avalanches : {true, false}) {
    SoilOptions options;
    options.avalanches = avalanches;
    SoilBed bed(steep, soil_preset("lete_sand"), options);
    Footprint plate = Footprint::box({0.02, 0.02, 0.02});
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << bed.surface().node_x(30), bed.surface().node_y(30), 0.05 + 0.01 - 0.001;
    plate.set_pose(pose);
    FootprintMotion motion;
    motion.mass_kg = std::numeric_limits<double>::infinity();
    ContactMemory memory;
    bed.press(plate, motion, kStep_s, memory);
    bed.end_step();
    pose.translation().z() += 1.0;  // it lifts: what it stood on may slide
    plate.set_pose(pose);
    for (int i = 0; i < 5; ++i) {
      bed.press(plate, motion, kStep_s, memory);
      bed.end_step();
    }
    const bool slid = bed.surface().node(30, 30) * kHeightUnit_m < 0.04;
    EXPECT_EQ(slid, avalanches);
    if (!avalanches) {
      EXPECT_EQ(bed.slopes_left(), 0U);
    }
  }
}

}  // namespace
}  // namespace screed
