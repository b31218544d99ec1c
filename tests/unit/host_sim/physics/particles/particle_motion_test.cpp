// Single particles against closed formulas: falling, resting, sliding, rolling, bouncing.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "host_sim/core/random.h"
#include "host_sim/physics/particles/particle_bed.h"

namespace screed {
namespace {

constexpr double kGravity = 9.80665;
constexpr double kRadius = 0.0125;

BedExtent box(double size) {
  BedExtent extent;
  extent.stacks_x = extent.stacks_y = static_cast<int>(std::lround(size / (2.0 * kRadius)));
  extent.width_m = extent.depth_m = size;
  return extent;
}

/// Gravity as on a plane that falls towards +x with this gradient.
ParticleOptions on_slope(double tangent) {
  ParticleOptions options;
  options.ray_spacing_m = 0.1;
  const double angle = std::atan(tangent);
  options.gravity = {kGravity * std::sin(angle), 0.0, -kGravity * std::cos(angle)};
  return options;
}

/// Height of the centre of a particle that rests on the floor.
double resting(const ParticleOptions& options) {
  const ParticleMaterial& m = options.material;
  return m.radius_m - m.mass_kg() * -options.gravity.z() / m.stiffness_n_per_m();
}

void run(ParticleBed& bed, double seconds) {
  const double dt = bed.longest_step_s();
  const auto steps = std::lround(seconds / dt);
  for (long i = 0; i < steps; ++i) bed.step(dt);
}

TEST(ParticleMaterial, IsAHomogeneousSphere) {
  ParticleMaterial material;
  material.radius_m = 0.0125;
  material.density_kg_per_m3 = 2600.0;
  EXPECT_NEAR(material.mass_kg(), 0.0212712, 1e-7);
  EXPECT_NEAR(material.inertia_kg_m2(), 0.4 * 0.0212712 * 0.0125 * 0.0125, 1e-12);
}

TEST(ParticleMotion, FallsFreely) {
  ParticleBed bed({{0.0, 0.0, 2.0}}, box(0.5), 2.1, {});
  const double dt = bed.longest_step_s();
  const int steps = 1000;
  for (int i = 0; i < steps; ++i) bed.step(dt);
  // Exactly what the integration makes of it: v = g t, and half a step more way than g t^2 / 2.
  const double time = steps * dt;
  EXPECT_NEAR(bed.velocity(0).z(), -kGravity * time, 1e-9);
  EXPECT_NEAR(2.0 - bed.position(0).z(), 0.5 * kGravity * time * (time + dt), 1e-9);
  EXPECT_EQ(bed.position(0).x(), 0.0);
}

TEST(ParticleMotion, RestsWhereTheFloorBearsItsWeightAndSleeps) {
  const ParticleOptions options;
  ParticleBed bed({{0.0, 0.0, kRadius}}, box(0.5), 0.1, options);
  run(bed, 1.0);
  EXPECT_NEAR(bed.position(0).z(), resting(options), 1e-7);
  EXPECT_FALSE(bed.awake(0));
  const Eigen::Vector3d there = bed.position(0);
  run(bed, 10.0);
  EXPECT_EQ(bed.position(0), there);
}

// A particle that cannot roll slides iff the slope is steeper than its friction.
TEST(ParticleMotion, SlidesIffTheSlopeLeavesTheFrictionCone) {
  for (const double friction : {0.3, 0.6, 0.9}) {
    for (const double share : {0.5, 0.97, 1.03, 1.5}) {
      ParticleOptions options = on_slope(share * friction);
      options.material.friction = friction;
      options.material.rolling = 5.0;
      ParticleBed bed({{0.0, 0.0, resting(options)}}, box(4.0), 0.1, options);
      run(bed, 0.5);
      const double begin = bed.velocity(0).x();
      if (share < 1.0) {
        EXPECT_EQ(begin, 0.0) << "friction " << friction << ", slope " << share;
        EXPECT_LT(bed.position(0).x(), 0.002);  // the springs had to be loaded
        EXPECT_FALSE(bed.awake(0));
      } else {
        run(bed, 0.5);
        const double angle = std::atan(share * friction);
        const double acceleration = kGravity * (std::sin(angle) - friction * std::cos(angle));
        EXPECT_NEAR((bed.velocity(0).x() - begin) / 0.5, acceleration, 0.01 * acceleration);
      }
    }
  }
}

// Rolling without slipping a sphere accelerates with 5/7 of what drives it, until 2/7 of that
// would need more than the friction: then it slips, and friction alone turns it.
TEST(ParticleMotion, RollsAndSlipsDownASlopeAsASphereDoes) {
  for (const double tangent : {0.2, 0.8, 1.2, 1.5}) {
    ParticleOptions options = on_slope(tangent);
    options.material.friction = 0.3;
    options.material.rolling = 0.0;
    ParticleBed bed({{-1.5, 0.0, resting(options)}}, box(4.0), 0.1, options);
    run(bed, 0.25);
    const double begin = bed.velocity(0).x();
    const double turning = bed.angular_velocity(0).y();
    run(bed, 0.5);
    const double angle = std::atan(tangent);
    const bool slips = tangent > 3.5 * 0.3;
    const double acceleration =
        kGravity * (slips ? std::sin(angle) - 0.3 * std::cos(angle) : 5.0 / 7.0 * std::sin(angle));
    const double turning_up =
        slips ? 2.5 * 0.3 * kGravity * std::cos(angle) / kRadius : acceleration / kRadius;
    EXPECT_NEAR((bed.velocity(0).x() - begin) / 0.5, acceleration, 0.01 * acceleration) << tangent;
    EXPECT_NEAR((bed.angular_velocity(0).y() - turning) / 0.5, turning_up, 0.02 * turning_up)
        << tangent;
  }
}

// The resisting moment rolling * r * N slows a rolling sphere by 5/7 rolling g.
TEST(ParticleMotion, RollingResistanceStopsARollingSphere) {
  ParticleOptions options;
  options.ray_spacing_m = 0.1;
  options.material.rolling = 0.1;
  const double speed = 0.5;
  ParticleBed bed({{-2.0, 0.0, resting(options)}}, box(10.0), 0.1, options);
  bed.set_motion(0, {speed, 0.0, 0.0}, {0.0, speed / kRadius, 0.0});
  run(bed, 3.0);
  const double distance = speed * speed / (2.0 * 5.0 / 7.0 * 0.1 * kGravity);
  EXPECT_NEAR(bed.position(0).x() + 2.0, distance, 0.02 * distance);
  EXPECT_FALSE(bed.awake(0));
}

// On a slope it begins to roll when the slope passes the resistance.
TEST(ParticleMotion, RollingResistanceHoldsOnGentleSlopes) {
  for (const double share : {0.9, 1.2}) {
    ParticleOptions options = on_slope(share * 0.1);
    options.material.rolling = 0.1;
    ParticleBed bed({{0.0, 0.0, resting(options)}}, box(10.0), 0.1, options);
    run(bed, 1.0);
    if (share < 1.0) {
      EXPECT_FALSE(bed.awake(0));
      EXPECT_LT(bed.position(0).x(), 0.001);
    } else {
      EXPECT_GT(bed.position(0).x(), 0.02);
    }
  }
}

// Two spheres that meet off centre, spinning, with nothing else in the world: momentum and angular
// momentum stay, to rounding.
TEST(ParticleMotion, ContactsKeepMomentumAndAngularMomentum) {
  ParticleOptions options;
  options.gravity.setZero();
  ParticleBed bed({{0.0, 0.0, 1.0}, {0.026, 0.01, 1.004}}, box(2.0), 2.0, options);
  bed.set_motion(0, {0.8, 0.1, 0.0}, {10.0, -20.0, 5.0});
  bed.set_motion(1, {-0.3, 0.0, 0.05}, {0.0, 8.0, -30.0});
  const double mass = options.material.mass_kg();
  const double inertia = options.material.inertia_kg_m2();
  const auto momentum = [&] { return Eigen::Vector3d(mass * (bed.velocity(0) + bed.velocity(1))); };
  const auto angular = [&] {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const size_t i : {0U, 1U}) {
      sum += mass * bed.position(i).cross(bed.velocity(i)) + inertia * bed.angular_velocity(i);
    }
    return sum;
  };
  const Eigen::Vector3d p = momentum();
  const Eigen::Vector3d l = angular();
  const Eigen::Vector3d before = bed.velocity(0);
  run(bed, 0.1);
  EXPECT_GT((bed.velocity(0) - before).norm(), 0.1);  // they did meet
  EXPECT_LT((momentum() - p).norm(), 1e-15);
  EXPECT_LT((angular() - l).norm(), 1e-15);
}

// A spring and damper that never pulls: Schwager and Poeschel, Granular Matter 9 (2007) 465.
TEST(ParticleMotion, BouncesWithTheRestitutionOfItsDamping) {
  for (const double damping : {0.1, 0.4}) {
    ParticleOptions options;
    options.gravity.setZero();
    options.material.damping_ratio = damping;
    options.material.friction = 0.0;
    ParticleBed bed({{-0.02, 0.0, 1.0}, {0.02, 0.0, 1.0}}, box(2.0), 2.0, options);
    bed.set_motion(0, {0.5, 0.0, 0.0}, Eigen::Vector3d::Zero());
    bed.set_motion(1, {-0.5, 0.0, 0.0}, Eigen::Vector3d::Zero());
    for (int i = 0; i < 3000; ++i) bed.step(2e-5);
    const double root = std::sqrt(1.0 - damping * damping);
    const double restitution = std::exp(
        -damping / root *
        (std::numbers::pi - std::atan2(2.0 * damping * root, 1.0 - 2.0 * damping * damping)));
    EXPECT_NEAR(bed.velocity(1).x() - bed.velocity(0).x(), restitution, 0.01 * restitution);
  }
}

TEST(ParticleMotion, WallsContainWhatIsThrownAtThem) {
  WorldRandom random(1, "test");
  std::vector<Eigen::Vector3d> centres;
  centres.reserve(300);
  for (int layer = 0; layer < 3; ++layer) {
    for (int row = 0; row < 10; ++row) {
      for (int column = 0; column < 10; ++column) {
        centres.emplace_back(0.03 * column - 0.135, 0.03 * row - 0.135, 0.03 * layer + 0.05);
      }
    }
  }
  const BedExtent extent = box(0.3);
  ParticleBed bed(centres, extent, 1.0, {});
  for (size_t i = 0; i < bed.size(); ++i) {
    bed.set_motion(i, {random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), 0.0},
                   Eigen::Vector3d::Zero());
  }
  // The deepest dent of a particle at 3 m/s: v sqrt(m / k), 6 mm.
  for (int k = 0; k < 20; ++k) {
    run(bed, 0.1);
    for (size_t i = 0; i < bed.size(); ++i) {
      const Eigen::Vector3d& at = bed.position(i);
      ASSERT_LT(at.head<2>().cwiseAbs().maxCoeff(), 0.15 - kRadius + 0.007);
      ASSERT_GT(at.z(), kRadius - 0.007);
    }
  }
}

// Without walls a particle that leaves on one side comes in on the other, and meets who is there.
TEST(ParticleMotion, ARepeatingBedHasNoEdge) {
  ParticleOptions options;
  options.gravity.setZero();
  options.material.friction = 0.0;
  options.material.damping_ratio = 0.0;
  BedExtent extent = box(0.5);
  extent.periodic = true;
  ParticleBed bed({{0.23, 0.0, 0.5}, {-0.2, 0.0, 0.5}}, extent, 1.0, options);
  bed.set_motion(0, {0.5, 0.0, 0.0}, Eigen::Vector3d::Zero());
  run(bed, 0.2);
  // Equal masses, elastic, head on: they exchange their speeds.
  EXPECT_NEAR(bed.velocity(1).x(), 0.5, 0.01);
  EXPECT_NEAR(bed.velocity(0).x(), 0.0, 0.01);
  EXPECT_LT(bed.position(0).x(), 0.0);
}

}  // namespace
}  // namespace screed
