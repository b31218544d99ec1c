// A body on soil springs: closed forms for one spring, and the balance of forces for many.
#include "host_sim/physics/soil/sinking.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "host_sim/core/constants.h"

namespace screed {
namespace {

constexpr double kStep_s = 0.001;

PressingBody body_of(double mass_kg, const Eigen::Vector3d& inertia = Eigen::Vector3d::Zero()) {
  PressingBody body;
  body.mass_kg = mass_kg;
  body.inverse_inertia.setZero();
  for (int i = 0; i < 3; ++i) {
    if (inertia[i] > 0.0) body.inverse_inertia(i, i) = 1.0 / inertia[i];
  }
  body.centre.setZero();
  body.velocity.setZero();
  body.omega.setZero();
  return body;
}

/// One spring; the solver takes them in blocks.
struct SoilSpring {
  double elastic;
  double elastic_slope;
  double virgin;
  double virgin_slope;
  double x;
  double y;
  double damper = 0.0;
  double sinking = 0.0;
};

int solve_sinking(const PressingBody& body, double dt, std::vector<SoilSpring>& springs,
                  BodyMemory& memory) {
  std::vector<SpringBlock> blocks(whole_blocks(springs.size()) / kLanes, SpringBlock{});
  for (size_t i = 0; i < springs.size(); ++i) {
    SpringBlock& block = blocks[i / kLanes];
    const size_t lane = i % kLanes;
    block.elastic[lane] = springs[i].elastic;
    block.elastic_slope[lane] = springs[i].elastic_slope;
    block.virgin[lane] = springs[i].virgin;
    block.virgin_slope[lane] = springs[i].virgin_slope;
    block.flowing[lane] = springs[i].virgin;
    block.flowing_slope[lane] = springs[i].virgin_slope;
    block.x[lane] = springs[i].x;
    block.y[lane] = springs[i].y;
    block.damper[lane] = springs[i].damper;
  }
  const bool damped = std::any_of(springs.begin(), springs.end(),
                                  [](const SoilSpring& spring) { return spring.damper > 0.0; });
  const int evaluations = screed::solve_sinking(body, dt, blocks, damped, memory);
  for (size_t i = 0; i < springs.size(); ++i) {
    springs[i].sinking = blocks[i / kLanes].sinking[i % kLanes];
  }
  return evaluations;
}

/// Soil that a body at rest neither loads nor unloads yet.
SoilSpring spring_at(double x, double y, double force, double elastic_slope = 1e7,
                     double virgin_slope = 1e4) {
  return {force, elastic_slope, force, virgin_slope, x, y};
}

TEST(Sinking, ABodySinksAlongTheVirginLineByWhatItsWeightNeeds) {
  // m q / dt^2 = f(q) - m g with f = k d, d = -q: one line, in closed form.
  const double mass = 5.0;
  const double slope = 2e5;
  std::vector<SoilSpring> springs = {{0.0, 1e9, 0.0, slope, 0.0, 0.0}};
  BodyMemory memory;
  solve_sinking(body_of(mass), kStep_s, springs, memory);
  const double inertia = mass / (kStep_s * kStep_s);
  EXPECT_NEAR(springs[0].sinking, mass * kGravity_m_per_s2 / (inertia + slope), 1e-12);
  EXPECT_TRUE(memory.touching);
  EXPECT_EQ(memory.rate, Eigen::Vector3d::Zero());
  EXPECT_NEAR(memory.soil_acceleration.x(), slope * springs[0].sinking / mass, 1e-9);
}

TEST(Sinking, NoDamperIsTooStrongForTheStep) {
  // m q / dt^2 = k d + D d - m g, d = -q: as one line, and of the damper only what goes down.
  const double mass = 5.0;
  const double slope = 2e5;
  for (const double damper : {1e3, 1e12}) {
    std::vector<SoilSpring> springs = {{0.0, 1e9, 0.0, slope, 0.0, 0.0, damper}};
    BodyMemory memory;
    solve_sinking(body_of(mass), kStep_s, springs, memory);
    const double inertia = mass / (kStep_s * kStep_s);
    const double expected = mass * kGravity_m_per_s2 / (inertia + slope + damper);
    EXPECT_NEAR(springs[0].sinking / expected, 1.0, 1e-9) << damper;
  }
  std::vector<SoilSpring> springs = {{30.0, 3e6, 30.0, 1e3, 0.0, 0.0, 1e12}};
  PressingBody body = body_of(mass);
  body.velocity.z() = 0.002;
  BodyMemory memory;
  memory.touching = true;
  memory.rate << 0.002, 0.0, 0.0;
  solve_sinking(body, kStep_s, springs, memory);
  const double inertia = mass / (kStep_s * kStep_s);
  EXPECT_NEAR(springs[0].sinking, -(inertia * 0.002 * kStep_s + 30.0) / (inertia + 3e6), 1e-11);
}

TEST(Sinking, ABodyThatRisesUnloadsAlongTheElasticLineAndThenLetsGo) {
  const double mass = 2.0;
  const double elastic = 3e6;
  const double inertia = mass / (kStep_s * kStep_s);
  for (const double speed : {0.002, 0.5}) {
    std::vector<SoilSpring> springs = {spring_at(0.0, 0.0, 30.0, elastic, 1e3)};
    PressingBody body = body_of(mass);
    body.velocity.z() = speed;
    BodyMemory memory;
    memory.touching = true;
    memory.rate << speed, 0.0, 0.0;  // as fast as before: nothing else pushes
    solve_sinking(body, kStep_s, springs, memory);
    // inertia (q - v dt) = max(0, f + elastic d), d = -q.
    const double touching = -(inertia * speed * kStep_s + 30.0) / (inertia + elastic);
    const double expected = 30.0 + elastic * touching > 0.0 ? touching : -speed * kStep_s;
    EXPECT_NEAR(springs[0].sinking, expected, 1e-11) << speed;
    EXPECT_NEAR(memory.soil_acceleration.x(),
                std::max(0.0, 30.0 + elastic * springs[0].sinking) / mass, 1e-5)
        << speed;
  }
}

TEST(Sinking, OnOneLineANewtonStepIsEnough) {
  std::vector<SoilSpring> springs = {{1.0, 1e9, 1.0, 2e5, 0.0, 0.0}};
  BodyMemory memory;
  EXPECT_EQ(solve_sinking(body_of(5.0), kStep_s, springs, memory), 1);
  EXPECT_EQ(
      solve_sinking(body_of(std::numeric_limits<double>::infinity()), kStep_s, springs, memory), 0);
}

TEST(Sinking, AStepThatOvershootsIsTakenBackByTheSecant) {
  // A body in the air that would come down by d = 0.1 mm: the spring begins at 0.4 d, and at d it
  // pushes with m d / dt^2. So the energy's slope there is what it was at the start with the other
  // sign, and the secant goes to half the way (second evaluation), which touches. From there it is
  // one line, and one step (third).
  const double d = 1e-4;
  const double mass = 1.0;
  const double push = mass * d / (kStep_s * kStep_s);
  const double stiffness = push / (0.6 * d);
  std::vector<SoilSpring> springs = {{-stiffness * 0.4 * d, stiffness, 1e6, stiffness, 0.0, 0.0}};
  PressingBody body = body_of(mass);
  body.velocity.z() = -d / kStep_s + kGravity_m_per_s2 * kStep_s;
  BodyMemory memory;
  EXPECT_EQ(solve_sinking(body, kStep_s, springs, memory), 3);
  const double inertia = mass / (kStep_s * kStep_s);
  EXPECT_NEAR(springs[0].sinking, (inertia * d + stiffness * 0.4 * d) / (inertia + stiffness),
              1e-15);
}

TEST(Sinking, WhatElsePushesIsWhatTheLastStepShowed) {
  const double mass = 2.0;
  const double slope = 1e4;
  const double inertia = mass / (kStep_s * kStep_s);
  struct Case {
    double speed_before;
    double by_soil;   // acceleration, m/s^2
    double external;  // expected
  };
  for (const Case c : {Case{0.1, 3.0, -7.0}, Case{0.05, 9.0, 37.0}, Case{-2.0, 0.0, 500.0},
                       Case{3.0, 0.0, -500.0}}) {
    std::vector<SoilSpring> springs = {{400.0, 1e9, 400.0, slope, 0.0, 0.0}};
    PressingBody body = body_of(mass);
    body.velocity.z() = 0.096;
    BodyMemory memory;
    memory.touching = true;
    memory.rate << c.speed_before, 0.0, 0.0;
    memory.soil_acceleration << c.by_soil, 0.0, 0.0;
    solve_sinking(body, kStep_s, springs, memory);
    const double free = body.velocity.z() * kStep_s + c.external * kStep_s * kStep_s;
    // inertia (q - free) = 400 - k q: k of the virgin line while it sinks, of the elastic one while
    // it rises, and no force once that is used up.
    const double sinks = (400.0 + inertia * free) / (inertia + slope);
    const double rises = (400.0 + inertia * free) / (inertia + 1e9);
    const double held = sinks < 0.0 ? sinks : rises;
    const double gone = 400.0 - 1e9 * held > 0.0 || held < 0.0 ? held : free;
    EXPECT_NEAR(springs[0].sinking, -gone, 1e-10) << c.speed_before;
  }
}

TEST(Sinking, AnImposedMotionIsLeftAlone) {
  std::vector<SoilSpring> springs = {spring_at(0.0, 0.0, 10.0)};
  BodyMemory memory;
  solve_sinking(body_of(std::numeric_limits<double>::infinity()), kStep_s, springs, memory);
  EXPECT_EQ(springs[0].sinking, 0.0);
  EXPECT_FALSE(memory.touching);
}

TEST(Sinking, WithoutInertiaItSinksAndDoesNotTilt) {
  std::vector<SoilSpring> springs = {spring_at(0.1, 0.0, 0.0), spring_at(-0.1, 0.05, 10.0)};
  PressingBody body = body_of(3.0);
  body.omega << 1.0, 2.0, 3.0;
  BodyMemory memory;
  solve_sinking(body, kStep_s, springs, memory);
  EXPECT_NEAR(springs[0].sinking, springs[1].sinking, 1e-9);
  EXPECT_EQ(memory.rate.y(), 0.0);
  EXPECT_EQ(memory.rate.z(), 0.0);
}

TEST(Sinking, ATurningBodyTiltsAboutTheWorldsAxes) {
  // Springs that carry nothing: it goes on as it turns.
  PressingBody body = body_of(3.0, {0.02, 0.03, 0.04});
  body.omega << 0.5, 0.0, 7.0;
  std::vector<SoilSpring> springs = {{0.0, 0.0, 0.0, 0.0, 0.1, 0.2}};
  BodyMemory memory;
  memory.touching = true;
  memory.rate << 0.0, 0.5, 0.0;
  solve_sinking(body, kStep_s, springs, memory);
  EXPECT_NEAR(springs[0].sinking, -0.5 * 0.2 * kStep_s, 1e-12) << "roll: what lies left rises";
  body.omega << 0.0, 0.4, 7.0;
  memory = {};
  memory.touching = true;
  memory.rate << 0.0, 0.0, 0.4;
  solve_sinking(body, kStep_s, springs, memory);
  EXPECT_NEAR(springs[0].sinking, 0.4 * 0.1 * kStep_s, 1e-12) << "pitch: what lies ahead sinks";
  EXPECT_NEAR(memory.rate.z(), 0.4, 0.0);
}

/// What of the balance M / dt^2 (q - free) = sum of forces is left, in m and rad.
Eigen::Vector3d residual(const PressingBody& body, const std::vector<SoilSpring>& springs,
                         const Eigen::Vector3d& q, const Eigen::Vector3d& external) {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const SoilSpring& s : springs) {
    const double down = -(q.x() + q.y() * s.y - q.z() * s.x);
    const double f = std::max(
        0.0, std::min(s.elastic + s.elastic_slope * down, s.virgin + s.virgin_slope * down));
    force += f * Eigen::Vector3d(1.0, s.y, -s.x);
  }
  // Of a symmetric inertia only the block of roll and pitch counts: yaw is free.
  Eigen::Matrix3d mobility = Eigen::Matrix3d::Zero();
  mobility(0, 0) = 1.0 / body.mass_kg;
  mobility.bottomRightCorner<2, 2>() = body.inverse_inertia.topLeftCorner<2, 2>();
  const Eigen::Vector3d rate(body.velocity.z(), body.omega.x(), body.omega.y());
  const Eigen::Vector3d free = rate * kStep_s + external * kStep_s * kStep_s;
  return (q - free) - kStep_s * kStep_s * (mobility * force);
}

TEST(Sinking, ManySpringsBalanceTheBody) {
  std::mt19937 random(3);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int trial = 0; trial < 200; ++trial) {
    PressingBody body = body_of(between(0.5, 20.0), {0.01, 0.02, 0.03});
    // Not along its axes.
    const Eigen::Matrix3d turned =
        Eigen::AngleAxisd(between(-1.0, 1.0), Eigen::Vector3d(1.0, 2.0, 3.0).normalized())
            .toRotationMatrix();
    body.inverse_inertia = turned * body.inverse_inertia * turned.transpose();
    body.velocity.z() = between(-0.5, 0.2);
    body.omega << between(-2.0, 2.0), between(-2.0, 2.0), 1.0;
    std::vector<SoilSpring> springs;
    for (int i = 0; i < 40; ++i) {
      const double force = between(0.0, 3.0);
      springs.push_back({force + between(0.0, 1.0), between(1e5, 1e7), force, between(1e2, 1e5),
                         between(-0.2, 0.2), between(-0.1, 0.1)});
    }
    BodyMemory memory;
    const bool first = trial % 2 == 0;
    Eigen::Vector3d external(-kGravity_m_per_s2, 0.0, 0.0);
    if (!first) {
      memory.touching = true;
      memory.rate << body.velocity.z() + 0.01, body.omega.x() - 0.02, body.omega.y() + 0.03;
      memory.soil_acceleration << 4.0, 3.0, -2.0;
      external << -10.0 - 4.0, 20.0 - 3.0, -30.0 + 2.0;
    }
    solve_sinking(body, kStep_s, springs, memory);
    // The displacement by three springs: sinking_i = -(q0 + q1 y_i - q2 x_i).
    Eigen::MatrixXd places(springs.size(), 3);
    Eigen::VectorXd sinking(springs.size());
    for (size_t i = 0; i < springs.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      places.row(row) << -1.0, -springs[i].y, springs[i].x;
      sinking(row) = springs[i].sinking;
    }
    const Eigen::Vector3d q = places.colPivHouseholderQr().solve(sinking);
    ASSERT_LT((places * q - sinking).norm(), 1e-12) << "a rigid body";
    const Eigen::Vector3d left = residual(body, springs, q, external);
    // On straight lines Newton's last step is exact: what is left is rounding.
    EXPECT_LT(std::abs(left.x()) + 0.1 * (std::abs(left.y()) + std::abs(left.z())), 1e-15) << trial;
    EXPECT_EQ(memory.rate, Eigen::Vector3d(body.velocity.z(), body.omega.x(), body.omega.y()));
    // What the soil did: (q - free) / dt^2.
    const Eigen::Vector3d rate = memory.rate;
    const Eigen::Vector3d by_soil = (q - rate * kStep_s) / (kStep_s * kStep_s) - external;
    EXPECT_LT((memory.soil_acceleration - by_soil).norm(), 0.05 + 1e-3 * by_soil.norm()) << trial;
  }
}

TEST(Sinking, WhatElseTiltsItIsKeptSane) {
  for (const int axis : {0, 1}) {  // roll, pitch
    PressingBody body = body_of(3.0, {0.02, 0.03, 0.04});
    body.omega[axis] = 20.0;
    std::vector<SoilSpring> springs = {
        {0.0, 0.0, 0.0, 0.0, axis == 1 ? -0.2 : 0.0, axis == 0 ? 0.2 : 0.0}};
    BodyMemory memory;
    memory.touching = true;  // a step ago it did not turn: 20000 rad/s^2
    solve_sinking(body, kStep_s, springs, memory);
    EXPECT_NEAR(springs[0].sinking, -(20.0 * kStep_s + 1e4 * kStep_s * kStep_s) * 0.2, 1e-9)
        << axis;
  }
}

TEST(Sinking, AHeavyBodyTiltsAsWell) {
  PressingBody body = body_of(200.0, {20.0, 30.0, 40.0});
  std::vector<SoilSpring> springs = {spring_at(0.5, 0.0, 100.0), spring_at(-0.5, 0.0, 0.0)};
  BodyMemory memory;
  solve_sinking(body, kStep_s, springs, memory);
  EXPECT_GT(springs[1].sinking, springs[0].sinking + 1e-8) << "it leans to where little carries it";
}

}  // namespace
}  // namespace screed
