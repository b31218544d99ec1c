// Bodies on walls against closed forms: a push is answered by as much, friction slows as Coulomb
// says, an impact gives no energy back that it did not take.
#include "host_sim/physics/vehicle/wall_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace screed {
namespace {

constexpr double kStep_s = 0.001;
constexpr double kMass_kg = 1.2;
constexpr double kFriction = 0.3;
constexpr BedBounds kBed{2.0, 3.0, BedEdge::kWalled};  // walls at x = -1, 1 and y = -1.5, 1.5

/// A body that moves in a plane of its own, integrated as ODE does.
struct Block {
  Block() { body.mass_kg = kMass_kg; }
  /// A box round the centre of mass that cannot turn, unless it is given an inertia.
  static Block box(double length, double width) {
    Block block;
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) block.walls.add_point({x * length, y * width, 0.0});
    }
    block.walls.close(kFriction, kMass_kg);
    return block;
  }
  /// The walls' force, N; `force` is anything else's.
  Eigen::Vector3d step(const Eigen::Vector3d& force = Eigen::Vector3d::Zero()) {
    Wrench wrench;
    walls.press(kBed, body, rotation, kStep_s, drives, wrench);
    body.velocity += (wrench.force + force) * kStep_s / body.mass_kg;
    body.omega += body.inverse_inertia * wrench.torque * kStep_s;
    body.centre += body.velocity * kStep_s;
    const double turn = body.omega.norm() * kStep_s;
    if (turn > 0.0) rotation = Eigen::AngleAxisd(turn, body.omega.normalized()) * rotation;
    return wrench.force;
  }
  double energy() const {
    double twice = body.mass_kg * body.velocity.squaredNorm();
    if (!body.inverse_inertia.isZero(0.0))
      twice += body.omega.squaredNorm() / body.inverse_inertia(2, 2);
    return 0.5 * twice;
  }

  PressingBody body;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  WallContact walls;
  std::vector<SurfaceDrive> drives;
};

TEST(WallContact, AnswersAPushByAsMuch) {
  for (const double side : {-1.0, 1.0}) {
    Block block = Block::box(0.2, 0.1);
    block.body.centre = {side * 0.9, 0.0, 0.0};
    const Eigen::Vector3d push(side * 8.0, 1.0, -2.0);
    Eigen::Vector3d answer;
    for (int i = 0; i < 1000; ++i) answer = block.step(push);
    EXPECT_LT((answer + push).norm(), 1e-6) << "2.2 N along the wall are below mu 8 N";
    EXPECT_LT(block.body.velocity.norm(), 1e-7);
    EXPECT_NEAR(side * block.body.centre.x(), 0.9, 1e-4);
  }
}

TEST(WallContact, ABodyThatOnlyJustFitsIsLeftAlone) {
  Block block = Block::box(2.0, 3.0);
  EXPECT_TRUE(block.step().isZero(0.0));
  EXPECT_TRUE(block.walls.touches().empty());
}

// m dv/dt = -mu N along a wall that the block is pushed against with N; then it stays.
TEST(WallContact, SlidesAlongAWallAsCoulombSays) {
  Block block = Block::box(0.2, 0.1);
  block.body.centre = {0.0, 1.45, 0.0};
  const Eigen::Vector3d push(0.0, 10.0, 0.0);
  for (int i = 0; i < 200; ++i) block.step(push);
  block.body.velocity.x() = 0.5;
  const double deceleration = kFriction * push.y() / kMass_kg;
  const double stops_after = 0.5 / deceleration;
  const double begin = block.body.centre.x();
  int steps = 0;
  for (; block.body.velocity.x() > 1e-4 && steps < 1000; ++steps) block.step(push);
  EXPECT_NEAR(steps * kStep_s, stops_after, 0.003);
  EXPECT_NEAR(block.body.centre.x() - begin, 0.5 * 0.5 * stops_after, 0.001);
  const double stands = block.body.centre.x();
  for (int i = 0; i < 2000; ++i) block.step(push);
  EXPECT_NEAR(block.body.centre.x(), stands, 3e-5);
  const double rests = block.body.centre.x();
  for (int i = 0; i < 2000; ++i) block.step(push);
  EXPECT_NEAR(block.body.centre.x(), rests, 1e-12) << "it creeps";
}

TEST(WallContact, FrictionHoldsUpToItsLimitAndNoFurther) {
  for (const double share : {0.95, 1.05}) {
    Block block = Block::box(0.2, 0.1);
    block.body.centre = {0.0, 1.45, 0.0};
    const Eigen::Vector3d push(share * kFriction * 10.0, 10.0, 0.0);
    for (int i = 0; i < 1000; ++i) block.step(push);
    if (share < 1.0) {
      EXPECT_LT(std::abs(block.body.centre.x()), 1e-4);
    } else {
      EXPECT_NEAR(block.body.velocity.x(), 0.05 * kFriction * 10.0 / kMass_kg, 0.01);
    }
  }
}

TEST(WallContact, StopsAtFullSpeedWithoutReboundAndLessThanAMillimetreDeep) {
  for (const double speed : {0.05, 0.25, 1.0}) {
    Block block = Block::box(0.2, 0.1);
    block.body.centre = {0.8, 0.0, 0.0};
    block.body.velocity = {speed, 0.0, 0.0};
    double deepest = 0.0;
    const double energy = block.energy();
    for (int i = 0; i < 6000; ++i) {
      block.step();
      deepest = std::max(deepest, block.body.centre.x() - 0.9);
      ASSERT_LE(block.energy(), energy) << "no energy comes from a wall";
    }
    EXPECT_GT(deepest, 0.0);
    EXPECT_LT(deepest, 0.001 * std::max(1.0, 2.0 * speed)) << speed;
    // Critically damped, a spring that does not pull gives exp(-2) of the speed back; two points
    // are damped more.
    EXPECT_GT(block.body.velocity.x(), -0.15 * speed) << "it bounces";
    EXPECT_LE(block.body.velocity.x(), 1e-9);
  }
}

// A rod that meets a wall with one end does not bounce there: with the end's lever l and
// I = m k^2 the impulse is m v / (1 + l^2 / k^2), the rest of the speed goes on as rotation.
TEST(WallContact, TurnsARodThatMeetsItWithOneEnd) {
  Block rod;
  constexpr double kLever_m = 0.1;
  constexpr double kInertia = kMass_kg * 0.2 * 0.2 / 12.0;
  rod.walls.add_point({0.0, kLever_m, 0.0});
  rod.walls.close(0.0, kMass_kg);
  rod.body.inverse_inertia = Eigen::Vector3d::Constant(1.0 / kInertia).asDiagonal();
  rod.body.centre = {0.9999, 0.0, 0.0};
  rod.body.velocity = {0.25, 0.0, 0.0};
  const double before = rod.energy();
  for (int i = 0; i < 60; ++i) {
    rod.step();
    ASSERT_LE(rod.energy(), before);
  }
  const double impulse = kMass_kg * 0.25 / (1.0 + kMass_kg * kLever_m * kLever_m / kInertia);
  // The spring gives the end a little of its speed back.
  const double got = kMass_kg * (0.25 - rod.body.velocity.x());
  EXPECT_GT(got, impulse);
  EXPECT_LT(got, 1.15 * impulse);
  EXPECT_NEAR(rod.body.omega.z(), got * kLever_m / kInertia, 1e-4);
}

TEST(WallContact, HoldsABodyInACorner) {
  Block block = Block::box(0.2, 0.1);
  block.body.centre = {-0.7, -1.2, 0.0};
  const Eigen::Vector3d push(-5.0, -7.0, 0.0);
  Eigen::Vector3d answer;
  for (int i = 0; i < 3000; ++i) answer = block.step(push);
  EXPECT_LT((answer + push).norm(), 1e-6);
  EXPECT_LT((block.body.centre - Eigen::Vector3d(-0.9, -1.45, 0.0)).norm(), 2e-4);
}

/// A wheel of 30 mm whose rim goes down where it meets the wall ahead.
Block wheel_at_a_wall(double omega_rad_per_s, double inverse_inertia) {
  Block wheel;
  wheel.walls.add_point({0.03, 0.0, 0.0}, {0.0, 0.0, -1.0}, 0, 0.03);
  wheel.walls.close(kFriction, kMass_kg);
  wheel.drives = {{omega_rad_per_s, inverse_inertia, 0.0}};
  wheel.body.centre = {0.97, 0.0, 0.0};
  return wheel;
}

// The wheel climbs with mu N, and mu N R brakes its shaft.
TEST(WallContact, BrakesAWheelThatSpinsOnIt) {
  Block wheel = wheel_at_a_wall(8.0, 1.0 / 7.5e-4);
  const Eigen::Vector3d push(6.0, 0.0, 0.0);
  Eigen::Vector3d force;
  for (int i = 0; i < 300; ++i) {
    wheel.drives[0] = {8.0, 1.0 / 7.5e-4, 0.0};  // the motor keeps its speed
    wheel.body.velocity.z() = 0.0;               // and something holds it down
    force = wheel.step(push);
  }
  EXPECT_NEAR(force.x(), -6.0, 1e-3);
  EXPECT_NEAR(force.z(), kFriction * 6.0, 1e-3);
  EXPECT_NEAR(wheel.drives[0].torque_n_m, -kFriction * 6.0 * 0.03, 1e-4);
}

// Contours are polygons: what pushes on one of their points pushes across the contour all the same.
TEST(WallContact, AWallWithoutFrictionBrakesNoWheel) {
  Block wheel;
  wheel.walls.add_point({0.03, 0.0, 0.0}, {-0.2, 0.0, -std::sqrt(0.96)}, 0, 0.03);
  wheel.walls.close(0.0, kMass_kg);
  wheel.drives = {{8.0, 1.0 / 7.5e-4, 0.0}};
  wheel.body.centre = {0.97, 0.0, 0.0};
  for (int i = 0; i < 300; ++i) wheel.step({6.0, 0.0, 0.0});
  EXPECT_NEAR(wheel.drives[0].torque_n_m, 0.0, 1e-12);
}

// A shaft that turns freely is stopped by the wall; the bent bristle hardly turns it back.
TEST(WallContact, StopsAFreeWheel) {
  constexpr double kInverseInertia = 1.0 / 1e-5;
  Block wheel = wheel_at_a_wall(8.0, kInverseInertia);
  double omega = 8.0;
  for (int i = 0; i < 500; ++i) {
    wheel.drives[0] = {omega, kInverseInertia, 0.0};
    wheel.step({6.0, 0.0, 0.0});
    wheel.body.velocity.z() = 0.0;
    omega += kInverseInertia * wheel.drives[0].torque_n_m * kStep_s;
    ASSERT_GT(omega, -0.3);
    ASSERT_LE(omega, 8.0);
  }
  EXPECT_NEAR(omega, 0.0, 1e-3);
}

// A side of many points is stiffer, not unstable.
TEST(WallContact, HoldsASideOfManyPoints) {
  Block side;
  for (int i = 0; i < 200; ++i) side.walls.add_point({0.05, -0.1 + 0.001 * i, 0.0});
  side.walls.close(kFriction, kMass_kg);
  side.body.inverse_inertia = Eigen::Vector3d::Constant(1.0 / 0.004).asDiagonal();
  side.body.centre = {0.9499, 0.0, 0.0};
  side.body.velocity = {0.25, 0.1, 0.0};
  const double before = side.energy();
  Eigen::Vector3d answer;
  for (int i = 0; i < 2000; ++i) {
    answer = side.step({8.0, 0.0, 0.0});
    ASSERT_LE(side.energy(), 1.1 * before);
    ASSERT_LT(side.body.centre.x(), 0.951);
  }
  EXPECT_NEAR(answer.x(), -8.0, 1e-3);
  EXPECT_LT(side.body.velocity.norm(), 1e-5);
  EXPECT_LT(side.body.omega.norm(), 1e-4);
}

}  // namespace
}  // namespace screed
