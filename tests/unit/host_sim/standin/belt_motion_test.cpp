// A robot on belts in closed form, against the formulas it is made of.
#include "host_sim/standin/belt_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
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
  EXPECT_GT(way, 0.0);
  EXPECT_LT(way, 4.0 * soil.shear_modulus_m);
}

// A stroke that is caught: the belt already runs ahead while the robot still comes back. It slips
// by many times K, so the soil holds with its whole strength until both are as fast.
TEST_F(BeltMotionTest, HoldsWithItsWholeStrengthWhileItSlipsLess) {
  const SoilParameters gravel = soil_preset("gravel");  // K = 1.7 mm, without cohesion
  BeltFit fit;
  fit.rolling = 0.0;
  BeltMotion caught(tracks, gravel, fit);
  caught.set_motion({-0.28 * kFrame_s, 0.0, 0.0}, level_support(tracks));
  const auto speed = [&] {
    return caught.step(0.27, 0.27, level_support(tracks)).forward_m / kFrame_s;
  };
  speed();
  const double friction = std::tan(gravel.friction_deg * std::numbers::pi / 180.0);
  double before = speed();
  while (before < 0.15) {
    const double after = speed();
    EXPECT_NEAR((after - before) / kFrame_s, kGravity_m_per_s2 * friction, 0.1) << before;
    before = after;
  }
}

// Where a belt slips evenly, what is mobilised below a patch is Janosi and Hanamoto's of the way
// from the leading end to its middle.
TEST_F(BeltMotionTest, IsExactWhereABeltSlipsEvenly) {
  const double patch_m = 2.0 * tracks.half_length_m / kBeltPatches;
  for (const double modulus_m : {0.05, 0.02}) {
    soil.shear_modulus_m = modulus_m;
    for (const double speed : {0.2, -0.2}) {
      BeltMotion held(tracks, soil);
      for (int i = 0; i < 1000; ++i) held.follow(speed, speed, level_support(tracks), {});
      EXPECT_DOUBLE_EQ(held.shear()[0].moved_m, 0.2 * kFrame_s);
      double mobilised = 0.0;
      for (std::size_t i = 0; i < kBeltPatches; ++i) {
        const double way = (static_cast<double>(i) + 0.5) * patch_m;
        mobilised += (1.0 - std::exp(-way / modulus_m)) / kBeltPatches;
      }
      for (const double traction : held.traction_n()) {
        EXPECT_NEAR(traction, std::copysign(0.5 * strength_n() * mobilised, speed),
                    1e-3 * strength_n())
            << modulus_m;
      }
    }
  }
}

// A frame's forces change the robot's motion as Newton says: forward, and about its middle, where
// the soil bears it in one place of each belt. What pulls sideways there follows from the motion.
TEST_F(BeltMotionTest, ForcesAreWhatTheMotionChangesBy) {
  BeltFit fit;
  fit.rolling = 0.0;
  BeltSupport support = level_support(tracks);
  support.load = {{{0.7, 0.0, 0.0}, {0.3, 0.0, 0.0}}};
  const double ahead = 2.0 * tracks.half_length_m / kBeltPatches;
  BeltMotion driven(tracks, soil, fit);
  FrameMotion before;
  for (int i = 0; i < 40; ++i) {
    const FrameMotion after = driven.step(0.2, 0.05, support);
    const double forward = after.forward_m / kFrame_s;
    const double left = after.sideways_m / kFrame_s;
    const double turn = after.turn_rad / kFrame_s;
    const double forward_before = before.forward_m / kFrame_s;
    const double left_before = before.sideways_m / kFrame_s;
    const double turn_before = before.turn_rad / kFrame_s;
    const auto [of_left, of_right] = driven.traction_n();
    EXPECT_NEAR(
        tracks.mass_kg * ((forward - forward_before) / kFrame_s - turn_before * left_before),
        of_left + of_right, 1e-9);
    const double sideways =
        tracks.mass_kg * ((left - left_before) / kFrame_s + turn_before * forward_before);
    EXPECT_NEAR(tracks.yaw_inertia_kg_m2 * (turn - turn_before) / kFrame_s,
                (of_right - of_left) * tracks.half_tread_m + sideways * ahead, 1e-9);
    before = after;
  }
  EXPECT_GT(std::abs(before.turn_rad), 0.0);
}

TEST_F(BeltMotionTest, WhatDoesNotTouchKeepsNothing) {
  BeltSupport on_a_crest = level_support(tracks);
  on_a_crest.front = {0.01, 0.01};
  on_a_crest.rear = {-0.01, -0.01};
  const FrameMotion aside{0.0, 1e-3, 0.0};
  BeltMotion after(tracks, soil);
  for (int i = 0; i < 100; ++i) after.follow(0.0, 0.0, on_a_crest, aside);
  after.follow(0.0, 0.0, level_support(tracks), aside);
  // Two frames of shear at most: that in which it does not touch any more, and this one.
  EXPECT_LT(after.shear()[0].patch_m[0], 2e-3 / soil.shear_modulus_m * 1e-3);
  EXPECT_GT(after.shear()[0].patch_m[1], 0.9e-3);
  EXPECT_LT(after.shear()[0].left_m, -0.3e-3) << "against the way that the robot goes";
}

// Front and rear end are each their own: on its rear third alone, and on its front third alone.
TEST_F(BeltMotionTest, EitherEndOfTheContactIsItsOwn) {
  const double third_m = 2.0 * tracks.half_length_m / kBeltPatches;
  const FrameMotion aside{0.0, 1e-3, 0.0};
  for (const bool at_rear : {true, false}) {
    BeltSupport support = level_support(tracks);
    if (at_rear) {
      support.front.fill(-tracks.half_length_m + third_m);
    } else {
      support.rear.fill(tracks.half_length_m - third_m);
    }
    BeltMotion belt(tracks, soil);
    for (int i = 0; i < 100; ++i) belt.follow(0.0, 0.0, support, aside);
    const std::array<double, kBeltPatches> patch_m = belt.shear()[0].patch_m;
    // All is mobilised where it touches, one frame's part where it does not.
    EXPECT_GT(patch_m[at_rear ? 2 : 0], 0.9e-3) << at_rear;
    EXPECT_LT(patch_m[1], 2e-3 / soil.shear_modulus_m * 1e-3) << at_rear;
    EXPECT_LT(patch_m[at_rear ? 0 : 2], 2e-3 / soil.shear_modulus_m * 1e-3) << at_rear;
  }
}

// Backward it is forward with its ends changed, sideways shear included.
TEST_F(BeltMotionTest, BackwardIsForwardMirrored) {
  BeltMotion backward(tracks, soil);
  BeltSupport support = level_support(tracks);
  support.load[0] = support.load[1] = {0.25, 0.15, 0.1};
  support.rear.fill(-0.05);
  BeltSupport mirrored = level_support(tracks);
  mirrored.load[0] = mirrored.load[1] = {0.1, 0.15, 0.25};
  mirrored.front.fill(0.05);
  for (int i = 0; i < 60; ++i) {
    belts.follow(0.2, 0.1, support, {0.001, 5e-4, 0.002});
    backward.follow(-0.2, -0.1, mirrored, {-0.001, 5e-4, -0.002});
  }
  for (const std::size_t side : {0U, 1U}) {
    const BeltShear one = belts.shear().at(side);
    const BeltShear two = backward.shear().at(side);
    EXPECT_NEAR(one.forward_m, -two.forward_m, 1e-15);
    EXPECT_NEAR(one.left_m, two.left_m, 1e-15);
    for (std::size_t i = 0; i < kBeltPatches; ++i)
      EXPECT_NEAR(one.patch_m[i], two.patch_m[kBeltPatches - 1 - i], 1e-15) << i;
    EXPECT_NEAR(belts.traction_n().at(side), -backward.traction_n().at(side), 1e-12);
  }
}

// A belt that stands and is dragged: the ground moves over it, faster on the outside of the turn;
// soil is sheared against the belt, backward as forward.
TEST_F(BeltMotionTest, ALockedBeltHasMovedAsFarAsTheGroundBelowIt) {
  for (const double way : {1.0, -1.0}) {
    BeltMotion locked(tracks, soil);
    for (int i = 0; i < 100; ++i)
      locked.follow(0.0, 0.0, level_support(tracks), {way * 0.001, 0.0, way * 0.005});
    const double wider = 0.005 * tracks.half_tread_m;
    const auto [left, right] = locked.shear();
    EXPECT_NEAR(left.moved_m, 0.001 - wider, 1e-12);
    EXPECT_NEAR(right.moved_m, 0.001 + wider, 1e-12);
    EXPECT_NEAR(right.slid_m, 0.001 + wider, 1e-12);
    EXPECT_LT(way * right.forward_m, 0.0);
    EXPECT_LT(way * locked.traction_n()[1], 0.0);
  }
}

}  // namespace
}  // namespace screed
