// Shear along a running surface against Wong's formulas for shear displacement.
#include "host_sim/physics/terrain/shear_field.h"

#include <gtest/gtest.h>

#include <cmath>

namespace screed {
namespace {

constexpr double kModulus_m = 0.01;
constexpr double kStep_s = 0.001;

RunMotion moving(double ahead, double aside, double surface_speed) {
  RunMotion motion;
  motion.velocity = {ahead, aside, 0.0};
  motion.omega.setZero();
  motion.surface_speed = surface_speed;
  return motion;
}

// Belt: j = s x, x from the front of the contact (Wong, Theory of Ground Vehicles, ch. 2), along
// the belt and not over the ground, whatever the slip and the sense of travel.
TEST(ShearFieldTest, BeltHasWongsDisplacement) {
  const RunContour belt{0.1, 0.03, 0.03, 0.02};
  for (const double speed : {0.2, -0.2}) {
    for (const double slip : {0.1, 0.4, 0.8}) {
      ShearField field;
      for (int i = 0; i < 3000; ++i) {
        field.advance(belt, moving(speed * (1.0 - slip), 0.0, speed), -0.1, 0.1, kModulus_m, 0.0,
                      kStep_s);
      }
      for (double x = 0.0; x <= 0.2; x += 0.01) {
        const double place = speed > 0.0 ? 0.1 - x : -0.1 + x;
        const double share = 1.0 - std::exp(-slip * x / kModulus_m);
        EXPECT_NEAR(field.at(place, 0.005).along, -std::copysign(share, speed), 0.004)
            << speed << " " << slip << " " << x;
        EXPECT_EQ(field.at(place, 0.005).across, 0.0);
      }
    }
  }
}

// Rim: j = r ((theta_1 - theta) - (1 - s) (sin theta_1 - sin theta)).
TEST(ShearFieldTest, RimHasWongsDisplacement) {
  constexpr double kRadius = 0.05;
  constexpr double kEntry = 0.8;
  constexpr double kSlip = 0.3;
  const RunContour rim{0.0, kRadius, kRadius, 0.02};
  ShearField field;
  for (int i = 0; i < 4000; ++i) {
    field.advance(rim, moving(0.1 * (1.0 - kSlip), 0.0, 0.1), -0.2 * kRadius, kEntry * kRadius,
                  kModulus_m, 0.0, kStep_s);
  }
  for (double theta = -0.2; theta < kEntry; theta += 0.05) {
    const double j =
        kRadius * ((kEntry - theta) - (1.0 - kSlip) * (std::sin(kEntry) - std::sin(theta)));
    EXPECT_NEAR(field.at(kRadius * theta, 0.0).along, -(1.0 - std::exp(-j / kModulus_m)), 0.006)
        << theta;
  }
}

// Turning on the spot, a belt that stands slides to one side ahead and to the other behind.
TEST(ShearFieldTest, ATurnSlidesTheEndsApart) {
  const RunContour belt{0.1, 0.0, 0.03, 0.02};
  RunMotion turning = moving(0.0, 0.0, 0.0);
  turning.omega = {0.0, 0.0, 0.5};
  ShearField field;
  for (int i = 0; i < 200; ++i) field.advance(belt, turning, -0.1, 0.1, kModulus_m, 0.0, kStep_s);
  const double j = 0.5 * 0.2 * 0.08;  // at 80 mm, in 0.2 s
  EXPECT_NEAR(field.at(0.08, 0.0).across, 1.0 - std::exp(-j / kModulus_m), 0.01);
  EXPECT_NEAR(field.at(-0.08, 0.0).across, -field.at(0.08, 0.0).across, 1e-9);
  EXPECT_NEAR(field.at(0.08, 0.0).sliding, 0.5 * 0.08, 0.002);
}

constexpr RunContour kBelt{0.1, 0.0, 0.03, 0.02};

/// A belt that has slid ahead, locked, until its shear is mobilised all along.
ShearField slid_belt() {
  ShearField field;
  for (int i = 0; i < 800; ++i)
    field.advance(kBelt, moving(0.1, 0.0, 0.0), -0.1, 0.1, kModulus_m, 0.0, kStep_s);
  return field;
}

// What was sheared lies still on the ground: a belt that trembles finds it again, but for what it
// has moved meanwhile.
TEST(ShearFieldTest, ContactThatIsFoundAgainIsRemembered) {
  ShearField field = slid_belt();
  for (int i = 0; i < 50; ++i)
    field.advance(kBelt, moving(0.1, 0.0, 0.0), -0.1, 0.02, kModulus_m, 0.0, kStep_s);
  field.advance(kBelt, moving(0.1, 0.0, 0.0), -0.1, 0.1, kModulus_m, 0.0, kStep_s);
  EXPECT_GT(field.at(0.09, 0.0).along, 0.99) << "5 mm are left behind";
  EXPECT_LT(field.at(0.098, 0.0).along, 0.05);
}

TEST(ShearFieldTest, GroundThatIsLeftBehindIsForgotten) {
  for (const Eigen::Vector3d& velocity :
       {Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Vector3d(0.0, 0.1, 0.0)}) {
    ShearField field = slid_belt();
    RunMotion motion = moving(0.0, 0.0, 0.0);
    motion.velocity = velocity;
    for (int i = 0; i < 700; ++i)  // 70 mm
      field.advance(kBelt, motion, -0.1, 0.0, kModulus_m, 0.0, kStep_s);
    field.advance(kBelt, moving(0.0, 0.0, 0.0), -0.1, 0.1, kModulus_m, 0.0, kStep_s);
    const auto mobilised = [&](double along) {
      const ShearField::Value here = field.at(along, 0.0);
      return std::hypot(here.along, here.across);
    };
    EXPECT_GT(mobilised(0.02), 0.9) << velocity.transpose();
    EXPECT_LT(mobilised(0.04), 0.02) << velocity.transpose();
  }
}

// A belt that rolls takes its material along: it has fresh soil in front.
TEST(ShearFieldTest, ARollingBeltsFrontMeetsFreshSoil) {
  ShearField field = slid_belt();
  for (int i = 0; i < 300; ++i)
    field.advance(kBelt, moving(0.2, 0.0, 0.2), -0.1, 0.04, kModulus_m, 0.0, kStep_s);
  field.advance(kBelt, moving(0.2, 0.0, 0.2), -0.1, 0.1, kModulus_m, 0.0, kStep_s);
  EXPECT_LT(field.at(0.05, 0.0).along, 0.02);
  EXPECT_GT(field.at(-0.05, 0.0).along, 0.9);
}

// However often it trembles: to and fro, up and down it stays over the same ground.
TEST(ShearFieldTest, TremblingForgetsNothing) {
  ShearField field = slid_belt();
  for (int i = 0; i < 1000; ++i) {
    RunMotion motion = moving(i % 2 == 0 ? 0.05 : -0.05, 0.0, 0.0);
    motion.velocity.z() = i % 20 < 10 ? 0.05 : -0.05;
    field.advance(kBelt, motion, -0.05, 0.05, kModulus_m, 0.0, kStep_s);
  }
  field.advance(kBelt, moving(0.0, 0.0, 0.0), -0.1, 0.1, kModulus_m, 0.0, kStep_s);
  EXPECT_GT(field.at(0.09, 0.0).along, 0.9);
  EXPECT_GT(field.at(-0.09, 0.0).along, 0.9);
}

TEST(ShearFieldTest, AHopIsRememberedAndAFlightIsNot) {
  const RunMotion ahead = moving(0.1, 0.0, 0.0);
  for (const auto& [seconds, remembers] : {std::pair{0.02, true}, {0.3, true}, {2.1, false}}) {
    ShearField field = slid_belt();
    const int steps = static_cast<int>(seconds / kStep_s);
    for (int i = 0; i < steps; ++i) field.hover(kBelt, ahead, kStep_s);
    field.advance(kBelt, ahead, -0.1, 0.1, kModulus_m, 0.0, kStep_s);
    EXPECT_EQ(field.at(-0.02, 0.0).along > 0.9, remembers) << seconds;
    EXPECT_EQ(field.at(0.08, 0.0).along > 0.9, seconds < 0.1) << seconds;
  }
}

}  // namespace
}  // namespace screed
