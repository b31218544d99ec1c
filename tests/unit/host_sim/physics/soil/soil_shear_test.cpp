// A shear box: a plate at a fixed depth slides over the soil, forth and back, against the closed
// form of Janosi-Hanamoto shear and what follows from it for the way back.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "host_sim/physics/soil/soil_bed.h"

namespace screed {
namespace {

constexpr double kSide_m = 0.05;
constexpr double kThickness_m = 0.02;
constexpr double kDepth_m = 0.002;
constexpr double kStep_s = 0.001;

class ShearBox {
 public:
  explicit ShearBox(const SoilParameters& soil)
      : soil_(soil),
        bed_(HeightField(31, 31, 0.005, false), soil, SoilOptions{NormalStress::kVertical}),
        plate_(Footprint::box({kSide_m, kSide_m, kThickness_m})) {
    motion_.mass_kg = std::numeric_limits<double>::infinity();
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().z() = 0.5 * kThickness_m - kDepth_m;
    plate_.set_pose(pose);
    for (int i = 0; i < 5; ++i) shear({0.0, 0.0}, kStep_s);  // until the area's b has settled
  }

  /// Shears by `displacement` (along the plate and across it, m) within `seconds`; returns what of
  /// the shear strength the soil answers with in the end, against the motion.
  Eigen::Vector2d shear(const Eigen::Vector2d& displacement, double seconds) {
    const auto steps = static_cast<int>(std::lround(seconds / kStep_s));
    motion_.velocity.x() = displacement.x() / seconds;
    motion_.velocity.y() = displacement.y() / seconds;
    Eigen::Vector2d mobilised = Eigen::Vector2d::Zero();
    for (int i = 0; i < steps; ++i) {
      const TerrainReaction reaction = bed_.press(plate_, motion_, kStep_s, memory_);
      bed_.end_step();
      const double strength =
          soil_.cohesion_pa * reaction.area +
          reaction.normal_load * std::tan(soil_.friction_deg * std::numbers::pi / 180.0);
      mobilised = -reaction.force.head<2>() / strength;
      work_j_ -= reaction.force.head<2>().dot(displacement) / steps;
    }
    return mobilised;
  }
  double work_j() const { return work_j_; }

 private:
  SoilParameters soil_;
  SoilBed bed_;
  Footprint plate_;
  ContactMemory memory_;
  FootprintMotion motion_;
  double work_j_ = 0.0;
};

SoilParameters undamped(const char* name) {
  SoilParameters soil = soil_preset(name);
  soil.shear_damping_s = 0.0;
  return soil;
}

TEST(SoilShearTest, OneWayIsJanosiAndHanamotos) {
  for (const char* name : {"viper", "lete_sand", "dry_sand", "clay"}) {
    const SoilParameters soil = undamped(name);
    ShearBox box(soil);
    double j = 0.0;
    for (int i = 0; i < 20; ++i) {
      j += 0.2 * soil.shear_modulus_m;
      const Eigen::Vector2d mobilised = box.shear({0.2 * soil.shear_modulus_m, 0.0}, 0.05);
      EXPECT_NEAR(mobilised.x(), 1.0 - std::exp(-j / soil.shear_modulus_m), 1e-6) << name << j;
      EXPECT_NEAR(mobilised.y(), 0.0, 1e-9);
    }
  }
}

// Back it gives up its elastic part, a tenth of K for the whole strength, and from zero shear on
// the curve begins anew: it does not spring back to where it began.
TEST(SoilShearTest, WhatTurnsBackMeetsTheSoilAnew) {
  const SoilParameters soil = undamped("viper");
  const double k = soil.shear_modulus_m;
  ShearBox box(soil);
  const double forth = box.shear({k, 0.0}, 0.1).x();
  EXPECT_NEAR(forth, 1.0 - std::exp(-1.0), 1e-6);
  const double back = box.shear({-k, 0.0}, 0.1).x();
  EXPECT_NEAR(back, -1.0 + std::exp(-(1.0 - 0.1 * forth)), 1e-6);
  const double again = box.shear({k, 0.0}, 0.1).x();
  EXPECT_NEAR(again, 1.0 - std::exp(-(1.0 + 0.1 * back)), 1e-6);
}

// What stands under load and trembles stays: the elastic part goes to and fro, nothing yields.
TEST(SoilShearTest, TremblingDoesNotCreep) {
  const SoilParameters soil = undamped("viper");
  const double k = soil.shear_modulus_m;
  ShearBox box(soil);
  const double loaded = box.shear({k, 0.0}, 0.1).x();
  double after = loaded;
  for (int i = 0; i < 50; ++i) {
    EXPECT_NEAR(box.shear({-0.02 * k, 0.0}, 0.01).x(), loaded - 0.2, 1e-6);
    after = box.shear({0.02 * k, 0.0}, 0.01).x();
  }
  EXPECT_NEAR(after, loaded, 1e-6);
}

// Turned aside, the strength follows the new way within a few elastic lengths and goes on growing.
TEST(SoilShearTest, TurnsWithTheWay) {
  const SoilParameters soil = undamped("ding_2011");
  const double k = soil.shear_modulus_m;
  ShearBox box(soil);
  const Eigen::Vector2d ahead = box.shear({2.0 * k, 0.0}, 0.1);
  const Eigen::Vector2d aside = box.shear({0.0, 1.5 * k}, 0.1);
  EXPECT_LT(std::abs(aside.x()), 1e-3);
  EXPECT_GT(aside.y(), ahead.x());
  EXPECT_LT(aside.y(), 1.0 - std::exp(-3.5));
  EXPECT_GT(aside.y(), 1.0 - std::exp(-3.2));
}

// A loop takes energy: with springs that give all back it would take none.
TEST(SoilShearTest, ALoopTakesEnergy) {
  const SoilParameters soil = undamped("lete_sand");
  const double k = soil.shear_modulus_m;
  ShearBox box(soil);
  box.shear({k, 0.0}, 0.1);
  box.shear({-2.0 * k, 0.0}, 0.2);
  const double before = box.work_j();
  box.shear({2.0 * k, 0.0}, 0.2);
  box.shear({-2.0 * k, 0.0}, 0.2);
  EXPECT_GT(box.work_j() - before, 0.4 * before);
}

// The elastic part is damped: at a rate v the stress is that of v times shear_damping further on.
// On the curve itself damping adds nothing.
TEST(SoilShearTest, TheElasticPartIsDamped) {
  SoilParameters soil = undamped("viper");
  soil.shear_damping_s = 0.01;
  const double k = soil.shear_modulus_m;
  ShearBox box(soil);
  const double loaded = box.shear({k, 0.0}, 0.1).x();
  EXPECT_NEAR(loaded, 1.0 - std::exp(-1.0), 1e-6);
  const double rate = 0.02 * k / 0.1;
  EXPECT_NEAR(box.shear({-0.02 * k, 0.0}, 0.1).x(),
              loaded - (0.02 * k + rate * soil.shear_damping_s) / (0.1 * k), 1e-6);
  EXPECT_LE(box.shear({20.0 * k, 0.0}, 0.1).x(), 1.0 + 1e-9);
}

// A wheel that spins and hardly moves: between the two means of place in a cell lies a way that
// takes it seconds, many times K of slip.
TEST(SoilShearTest, AWheelThatSpinsOnTheSpotFeelsNoMoreThanTheStrength) {
  SoilParameters soil = soil_preset("lete_sand");
  soil.shear_modulus_m = 0.002;
  SoilBed bed(HeightField(61, 61, 0.005, false), soil);
  Footprint wheel = Footprint::wheel(0.03, 0.025);
  ContactMemory memory;
  FootprintMotion motion;
  motion.mass_kg = std::numeric_limits<double>::infinity();
  motion.velocity.x() = 0.00105;
  motion.surface_speed = 3.0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 2000; ++i) {
    pose.translation() << motion.velocity.x() * i * kStep_s, 0.0, 0.03 - 0.003;
    wheel.set_pose(pose);
    const TerrainReaction reaction = bed.press(wheel, motion, kStep_s, memory);
    bed.end_step();
    ASSERT_TRUE(reaction.force.allFinite() && reaction.torque.allFinite()) << "step " << i;
    ASSERT_LT(reaction.force.head<2>().norm(), 2.0 * reaction.normal_load + 10.0) << "step " << i;
  }
}

// Where the pressure in a cell lies ahead of the middle of what it touches, the soil has sheared
// for less long there. It cannot have sheared the other way: a wheel that slips is not drawn back.
TEST(SoilShearTest, AWheelThatSlipsIsDrawnForwardFromTheFirstStepOn) {
  SoilParameters soil = soil_preset("viper");
  for (const double shear_modulus_m : {0.002, 0.02}) {
    for (const double slip_speed : {0.01, 0.1, 1.0}) {
      soil.shear_modulus_m = shear_modulus_m;
      SoilBed bed(HeightField(61, 61, 0.005, false), soil, SoilOptions{NormalStress::kVertical});
      Footprint wheel = Footprint::wheel(0.03, 0.025);
      ContactMemory memory;
      FootprintMotion motion;
      motion.mass_kg = std::numeric_limits<double>::infinity();
      motion.velocity.x() = 0.002;
      motion.surface_speed = motion.velocity.x() + slip_speed;
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      for (int i = 0; i < 2000; ++i) {
        pose.translation() << motion.velocity.x() * i * kStep_s, 0.0, 0.03 - 0.003;
        wheel.set_pose(pose);
        const TerrainReaction reaction = bed.press(wheel, motion, kStep_s, memory);
        bed.end_step();
        ASSERT_GE(reaction.force.x(), 0.0)
            << shear_modulus_m << " " << slip_speed << ", step " << i;
      }
    }
  }
}

}  // namespace
}  // namespace screed
