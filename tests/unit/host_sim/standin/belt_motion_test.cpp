// A robot on belts in closed form, against the formulas it is made of.
#include "host_sim/standin/belt_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hal/sample.h"
#include "host_sim/core/gravity.h"
#include "host_sim/physics/soil/soil_parameters.h"

namespace screed {
namespace {

constexpr double kFrame_s = 1.0 / kTickRate_hz;

class BeltMotionTest : public ::testing::Test {
 protected:
  BeltSupport on_slope(double forward, double left) const {
    BeltSupport support = level_support(tracks);
    support.forward = forward;
    support.left = left;
    return support;
  }
  double strength_n() const {
    return tracks.mass_kg * kGravity_m_per_s2 *
           std::tan(soil.friction_deg * std::numbers::pi / 180.0);
  }

  TrackGeometry tracks;
  SoilParameters soil = soil_preset("viper");  // without cohesion
  BeltMotion belts{tracks, soil};
};

// Static friction: it creeps by no more than what shears the soil, and then not at all.
TEST_F(BeltMotionTest, StandsOnASlopeThatHolds) {
  const BeltSupport support = on_slope(0.35, 0.2);
  PlanarPose pose;
  for (int i = 0; i < 500; ++i) pose.move(belts.step(0.0, 0.0, support));
  EXPECT_LT(std::hypot(pose.x_m, pose.y_m), 2.0 * soil.shear_modulus_m);
  const PlanarPose before = pose;
  for (int i = 0; i < 60 * kTickRate_hz; ++i) pose.move(belts.step(0.0, 0.0, support));
  EXPECT_LT(std::hypot(pose.x_m - before.x_m, pose.y_m - before.y_m), 1e-6);
}

TEST_F(BeltMotionTest, SlidesDownWhereItIsTooSteep) {
  const double slope = 1.2;
  const BeltSupport support = on_slope(slope, 0.0);
  BeltFit fit;
  fit.rolling = 0.0;
  BeltMotion sliding(tracks, soil, fit);
  for (int i = 0; i < 100; ++i) sliding.step(0.0, 0.0, support);
  const double before = sliding.step(0.0, 0.0, support).forward_m / kFrame_s;
  for (int i = 0; i < 49; ++i) sliding.step(0.0, 0.0, support);
  const double after = sliding.step(0.0, 0.0, support).forward_m / kFrame_s;
  const double cosine = 1.0 / std::sqrt(1.0 + slope * slope);
  const double friction = std::tan(soil.friction_deg * std::numbers::pi / 180.0);
  // Along the slope, seen from above.
  const double acceleration = kGravity_m_per_s2 * cosine * (slope - friction) * cosine;
  EXPECT_NEAR((before - after) / 0.5, acceleration, 0.01 * acceleration);
}

// Janosi and Hanamoto, integrated along a belt that slips evenly (Wong, Theory of Ground Vehicles):
// pull = S (1 - K / (s L) (1 - exp(-s L / K))).
TEST_F(BeltMotionTest, PullsAsJanosiAndHanamotoSay) {
  BeltFit fit;
  fit.rolling = 0.0;
  constexpr double kBelt_m_per_s = 0.1;
  for (const double share : {0.5, 0.7, 0.85}) {
    BeltMotion pulling(tracks, soil, fit);
    const Eigen::Vector3d drawbar(-share * strength_n(), 0.0, 0.0);
    FrameMotion motion;
    for (int i = 0; i < 3000; ++i)
      motion = pulling.step(kBelt_m_per_s, kBelt_m_per_s, level_support(tracks), drawbar);
    const double slip = 1.0 - motion.forward_m / kFrame_s / kBelt_m_per_s;
    const double x = slip * 2.0 * tracks.half_length_m / soil.shear_modulus_m;
    EXPECT_NEAR(1.0 - (1.0 - std::exp(-x)) / x, share, 0.03) << share;
    EXPECT_NEAR(pulling.traction_n()[0] + pulling.traction_n()[1], share * strength_n(), 1e-3);
  }
}

// The same of belts that touch on two centimetres of their length alone: what comes into contact
// there is fresh.
TEST_F(BeltMotionTest, ShearBeginsWhereContactDoes) {
  BeltFit fit;
  fit.rolling = 0.0;
  constexpr double kBelt_m_per_s = 0.1;
  constexpr double kContact_m = 0.02;
  BeltSupport support = level_support(tracks);
  for (const std::size_t side : {0U, 1U}) {
    support.load.at(side) = {0.0, 0.5, 0.0};
    support.area.at(side) = {0.0, kContact_m * tracks.width_m, 0.0};
    support.front.at(side) = 0.5 * kContact_m;
    support.rear.at(side) = -0.5 * kContact_m;
  }
  for (const double share : {0.3, 0.5}) {
    BeltMotion pulling(tracks, soil, fit);
    const Eigen::Vector3d drawbar(-share * strength_n(), 0.0, 0.0);
    FrameMotion motion;
    for (int i = 0; i < 3000; ++i)
      motion = pulling.step(kBelt_m_per_s, kBelt_m_per_s, support, drawbar);
    const double slip = 1.0 - motion.forward_m / kFrame_s / kBelt_m_per_s;
    const double x = slip * kContact_m / soil.shear_modulus_m;
    EXPECT_NEAR(1.0 - (1.0 - std::exp(-x)) / x, share, 0.05) << share;
  }
}

TEST_F(BeltMotionTest, TurnsLessThanItsBeltsAndToTheSideOfTheSlowerOne) {
  FrameMotion motion;
  for (int i = 0; i < 300; ++i) motion = belts.step(0.05, 0.15, level_support(tracks));
  const double kinematic = 0.1 / (2.0 * tracks.half_tread_m) * kFrame_s;
  EXPECT_GT(motion.turn_rad, 0.3 * kinematic);
  EXPECT_LT(motion.turn_rad, kinematic);
}

TEST_F(BeltMotionTest, LeftAndRightAreMirrorImages) {
  BeltMotion mirrored(tracks, soil);
  BeltSupport support = on_slope(0.1, 0.15);
  support.load[0] = {0.3, 0.2, 0.1};
  support.load[1] = {0.1, 0.2, 0.1};
  BeltSupport other = on_slope(0.1, -0.15);
  other.load = {support.load[1], support.load[0]};
  for (int i = 0; i < 200; ++i) {
    const FrameMotion one = belts.step(0.2, -0.1, support);
    const FrameMotion two = mirrored.step(-0.1, 0.2, other);
    ASSERT_NEAR(one.forward_m, two.forward_m, 1e-12);
    ASSERT_NEAR(one.sideways_m, -two.sideways_m, 1e-12);
    ASSERT_NEAR(one.turn_rad, -two.turn_rad, 1e-12);
  }
}

// What is mobilised at a reversal is turned round within the way that shears the soil, not within
// all that has slipped before.
TEST_F(BeltMotionTest, ReversesWithoutUnwindingItsSlip) {
  const Eigen::Vector3d drawbar(-0.9 * strength_n(), 0.0, 0.0);
  double slid = 0.0;
  for (int i = 0; i < 300; ++i) {
    belts.step(0.2, 0.2, level_support(tracks), drawbar);
    slid += belts.shear()[0].slid_m;
  }
  ASSERT_GT(slid, 20.0 * soil.shear_modulus_m);
  double way = 0.0;
  while (belts.traction_n()[0] > -0.3 * strength_n() && way < 1.0) {
    belts.step(-0.2, -0.2, level_support(tracks));
    way += belts.shear()[0].slid_m;
  }
  EXPECT_LT(way, 4.0 * soil.shear_modulus_m);
}

}  // namespace
}  // namespace screed
