// Two bodies that meet: momentum is kept whatever they do, they part, friction has its limit.
#include "host_sim/physics/vehicle/robot_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "host_sim/physics/terrain/solid_contact.h"

namespace screed {
namespace {

constexpr double kStep_s = 0.001;

/// A box that flies without gravity.
class Box {
 public:
  Box(const Eigen::Vector3d& size, double mass_kg) : size_(size), mass_(mass_kg) {
    // Corners, and the middles of edges and faces: of boxes in line the corners are on each other's
    // faces.
    for (const double x : {-0.5, 0.0, 0.5}) {
      for (const double y : {-0.5, 0.0, 0.5}) {
        for (const double z : {-0.5, 0.0, 0.5}) {
          points_.push_back({size.cwiseProduct(Eigen::Vector3d(x, y, z)), Eigen::Vector3d::Zero(),
                             kNoSurfaceDrive, 0.0});
        }
      }
    }
    solids_.push_back({Footprint::box(size), Eigen::Isometry3d::Identity()});
    const Eigen::Vector3d square = size.cwiseAbs2();
    inertia_ =
        (mass_kg / 12.0 *
         Eigen::Vector3d(square.y() + square.z(), square.x() + square.z(), square.x() + square.y()))
            .asDiagonal();
  }

  /// Moves the box's surface with a drive: every point of it, and its solid.
  void drive(double omega_rad_per_s) { drives_ = {{omega_rad_per_s, 1e3, 0.0}}; }

  RobotBody body() {
    PressingBody motion;
    motion.mass_kg = mass_;
    motion.inverse_inertia = rotation * inertia_.inverse() * rotation.transpose();
    motion.centre = centre;
    motion.velocity = velocity;
    motion.omega = omega;
    return {motion, rotation, 0.5 * size_.norm(), points_, solids_, mass_, drives_, wrench};
  }
  void step() {
    velocity += kStep_s / mass_ * wrench.force;
    // Angular momentum is what a torque changes.
    spin_ = rotation * inertia_ * rotation.transpose() * omega + kStep_s * wrench.torque;
    centre += kStep_s * velocity;
    const Eigen::Vector3d turn = kStep_s * omega;
    if (turn.norm() > 0.0)
      rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * rotation;
    omega = rotation * inertia_.inverse() * rotation.transpose() * spin_;
    wrench = {};
  }
  Eigen::Vector3d momentum() const { return mass_ * velocity; }
  /// About the world's origin.
  Eigen::Vector3d angular_momentum() const {
    return rotation * inertia_ * rotation.transpose() * omega + centre.cross(momentum());
  }
  double energy() const {
    return 0.5 * mass_ * velocity.squaredNorm() +
           0.5 * omega.dot(rotation * inertia_ * rotation.transpose() * omega);
  }

  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();
  Wrench wrench;

 private:
  Eigen::Vector3d size_;
  double mass_;
  Eigen::Matrix3d inertia_;
  Eigen::Vector3d spin_ = Eigen::Vector3d::Zero();
  std::vector<BodyPoint> points_;
  std::vector<SolidPart> solids_;
  std::vector<SurfaceDrive> drives_;
};

TEST(RobotContact, AnObliqueImpactKeepsMomentumAndAngularMomentum) {
  Box one({0.2, 0.2, 0.1}, 1.4);
  Box other({0.3, 0.2, 0.1}, 2.1);
  one.centre << -0.3, 0.06, 0.0;
  one.velocity << 0.5, 0.0, 0.0;
  one.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  other.velocity << -0.2, 0.05, 0.0;
  const Eigen::Vector3d momentum = one.momentum() + other.momentum();
  const Eigen::Vector3d spin = one.angular_momentum() + other.angular_momentum();
  const double energy = one.energy() + other.energy();

  RobotContact contact(0.5);
  double deepest = 0.0;
  for (int i = 0; i < 1000; ++i) {
    deepest = std::max(deepest, contact.depth(one.body(), other.body()));
    contact.press(one.body(), other.body(), kStep_s);
    one.step();
    other.step();
  }
  EXPECT_GT(deepest, 1e-4) << "they have met";
  EXPECT_LT(deepest, 0.004);
  EXPECT_LT((one.momentum() + other.momentum() - momentum).norm(), 1e-12);
  // The turning of a body within a step is a little off, the forces' couple is not.
  EXPECT_LT((one.angular_momentum() + other.angular_momentum() - spin).norm(), 1e-3 * 0.7);
  EXPECT_LT(one.energy() + other.energy(), energy);
  EXPECT_GT((other.velocity - one.velocity).x(), -1e-6) << "they have parted";
}

TEST(RobotContact, InOneStepForceAndTorqueAreExactlyOpposite) {
  Box one({0.2, 0.2, 0.1}, 1.4);
  Box other({0.2, 0.2, 0.1}, 1.4);
  one.centre << -0.198, 0.03, 0.01;
  one.velocity << 0.4, 0.1, -0.2;
  one.omega << 1.0, -2.0, 3.0;
  one.drive(5.0);
  RobotContact contact(0.5);
  contact.press(one.body(), other.body(), kStep_s);
  ASSERT_GT(other.wrench.force.x(), 1.0);
  EXPECT_LT((one.wrench.force + other.wrench.force).norm(), 1e-12);
  const Eigen::Vector3d about_origin = one.wrench.torque + one.centre.cross(one.wrench.force) +
                                       other.wrench.torque + other.centre.cross(other.wrench.force);
  EXPECT_LT(about_origin.norm(), 1e-12);
}

TEST(RobotContact, FrictionIsWithinCoulombsLimit) {
  for (const double friction : {0.0, 0.3}) {
    Box one({0.2, 0.2, 0.1}, 1.4);
    Box other({0.2, 0.2, 0.1}, 1.4);
    one.centre << -0.199, 0.0, 0.0;
    one.velocity << 0.0, 1.0, 0.0;
    RobotContact contact(friction);
    contact.press(one.body(), other.body(), kStep_s);
    ASSERT_GT(other.wrench.force.x(), 0.0);
    EXPECT_NEAR(other.wrench.force.y(), friction * other.wrench.force.x(), 1e-9);
  }
}

TEST(RobotContact, TheSameDepthPushesAsHardWhateverTheSteps) {
  Box other({0.2, 0.2, 0.1}, 1.4);
  std::vector<double> forces;
  for (const double step_s : {1e-6, 1e-4}) {
    Box one({0.2, 0.2, 0.1}, 1.4);
    one.centre << -0.199, 0.0, 0.0;
    RobotContact(0.0).press(one.body(), other.body(), step_s);
    forces.push_back(one.wrench.force.x());
  }
  // Spring of the reduced mass at 200 rad/s, 1 mm deep.
  EXPECT_NEAR(forces[0], -0.7 * 200.0 * 200.0 * 0.001, 0.1);
  EXPECT_NEAR(forces[1], forces[0], 0.05 * std::abs(forces[0]));
}

TEST(RobotContact, PointsInTheMiddleOfRunningGearAreRoundItsSolid) {
  const RunningGearGeometry gear{{0.1, 0.08, 0.02}, {-0.06, 0.08, 0.02}, 0.025, 0.03};
  const SolidPart solid = solid_of(gear, 3);
  EXPECT_EQ(solid.drive, 3U);
  Eigen::AlignedBox3d box;
  for (const BodyPoint& point : middle_of(gear, 3)) {
    const SolidContact near = nearest_on(solid.shape, solid.pose.inverse() * point.at);
    EXPECT_NEAR(near.distance, 0.0, 1e-12);
    EXPECT_LT((solid.pose.linear() * near.belt - point.along).norm(), 1e-9);
    EXPECT_NEAR(point.at.y(), 0.08, 1e-12);
    box.extend(point.at);
  }
  EXPECT_NEAR(box.max().x(), 0.125, 0.001);
  EXPECT_NEAR(box.min().x(), -0.085, 0.001);
}

TEST(RobotContact, BodiesApartDoNothing) {
  Box one({0.2, 0.2, 0.1}, 1.4);
  Box other({0.2, 0.2, 0.1}, 1.4);
  one.centre << -0.201, 0.0, 0.0;
  one.velocity << 1.0, 0.0, 0.0;
  RobotContact contact(0.5);
  contact.press(one.body(), other.body(), kStep_s);
  EXPECT_EQ(one.wrench.force.norm(), 0.0);
  EXPECT_EQ(contact.depth(one.body(), other.body()), 0.0);
}

}  // namespace
}  // namespace screed
