// The grid must not show: what a body meets is the same across the seam of a bed that repeats, in
// all four directions of the grid, and mirrored; at the edge of a bed nothing is met beyond it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "host_sim/physics/soil/soil_bed.h"

namespace screed {
namespace {

constexpr double kSpacing_m = 0.005;
constexpr int kNodes = 64;
constexpr double kStep_s = 0.001;

/// A wheel or plate, where it is, how it moves; all in the axes of its yaw.
struct Contact {
  Footprint footprint = Footprint::wheel(0.06, 0.05);
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // world
  double yaw = 0.0;
  double roll = 0.0;
  double pitch = 0.0;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();
  double surface_speed = 0.0;
};

struct Reaction {
  Eigen::Vector3d force;
  Eigen::Vector3d torque;
  double area;
  double along_surface;
};

/// Presses it for some steps with its motion imposed; the last reaction in the axes of its yaw.
Reaction press(SoilBed& bed, Contact contact, int steps = 6) {
  const Eigen::Matrix3d yaw =
      Eigen::AngleAxisd(contact.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = contact.at;
  pose.linear() = yaw * Eigen::AngleAxisd(contact.pitch, Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(contact.roll, Eigen::Vector3d::UnitX()).toRotationMatrix();
  FootprintMotion motion;
  motion.mass_kg = std::numeric_limits<double>::infinity();
  motion.velocity = yaw * contact.velocity;
  motion.omega = yaw * contact.omega;
  motion.surface_speed = contact.surface_speed;
  ContactMemory memory;
  TerrainReaction reaction;
  for (int i = 0; i < steps; ++i) {
    contact.footprint.set_pose(pose);
    reaction = bed.press(contact.footprint, motion, kStep_s, memory);
    bed.end_step();
    pose.translation() += motion.velocity * kStep_s;
  }
  return {yaw.transpose() * reaction.force, yaw.transpose() * reaction.torque, reaction.area,
          reaction.along_surface};
}

SoilBed bed_of(bool wrap, const SoilOptions& options = {}) {
  return {HeightField(kNodes, kNodes, kSpacing_m, wrap), soil_preset("lete_sand"), options};
}

Contact slipping_wheel() {
  Contact wheel;
  wheel.at << 0.001, 0.002, 0.06 - 0.006;
  wheel.roll = 0.15;
  wheel.pitch = 0.1;
  wheel.velocity << 0.2, 0.07, -0.05;
  wheel.omega << 0.2, 0.1, 0.3;
  wheel.surface_speed = 0.3;
  return wheel;
}

void expect_alike(const Reaction& a, const Reaction& b, double share, const char* what) {
  EXPECT_LT((a.force - b.force).norm(), share * a.force.norm())
      << what << ": " << a.force.transpose() << " and " << b.force.transpose();
  EXPECT_LT((a.torque - b.torque).norm(), share * (a.torque.norm() + 0.06 * a.force.norm()))
      << what << ": " << a.torque.transpose() << " and " << b.torque.transpose();
  // A cell that hardly carries counts with all of its area: which do is a matter of rounding.
  EXPECT_NEAR(a.area, b.area, 2.0 * share * a.area) << what;
  EXPECT_NEAR(a.along_surface, b.along_surface, share * a.force.norm()) << what;
}

TEST(SoilCells, ABodyAcrossTheSeamOfABedThatRepeatsMeetsTheSame) {
  SoilBed middle = bed_of(true);
  const Contact wheel = slipping_wheel();
  const Reaction here = press(middle, wheel);
  ASSERT_GT(here.force.z(), 1.0);
  for (const Eigen::Vector2d& seam : {Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(0.0, 1.0),
                                      Eigen::Vector2d(-1.0, 0.0), Eigen::Vector2d(0.0, -1.0)}) {
    SoilBed bed = bed_of(true);
    Contact moved = wheel;
    const double width = kNodes * kSpacing_m;
    moved.at.head<2>() += 0.5 * width * seam;
    expect_alike(here, press(bed, moved), 1e-6, "across the seam");
  }
}

TEST(SoilCells, WhatHangsOverTheEdgeMeetsNothingThere) {
  // A plate with one half beyond the last nodes, on each of the four sides.
  for (int side = 0; side < 4; ++side) {
    SoilBed bed = bed_of(false);
    const HeightField& field = bed.surface();
    Contact plate;
    plate.footprint = Footprint::box({0.1, 0.1, 0.02});
    plate.at.z() = 0.01 - 0.003;
    const double middle_x = 0.5 * (field.x_min() + field.x_max());
    const double middle_y = 0.5 * (field.y_min() + field.y_max());
    plate.at.x() = side == 0 ? field.x_max() : side == 1 ? field.x_min() : middle_x;
    plate.at.y() = side == 2 ? field.y_max() : side == 3 ? field.y_min() : middle_y;
    const Reaction reaction = press(bed, plate);
    EXPECT_NEAR(reaction.area, 0.5 * 0.01, 0.06 * 0.01) << side;
    // Nothing wrapped round to the edge that lies opposite.
    for (int i = 0; i < kNodes; ++i) {
      const Height opposite = side == 0   ? field.node(0, i)
                              : side == 1 ? field.node(kNodes - 1, i)
                              : side == 2 ? field.node(i, 0)
                                          : field.node(i, kNodes - 1);
      EXPECT_EQ(opposite, 0) << side << " " << i;
    }
  }
}

TEST(SoilCells, TheGridsFourDirectionsAreTheSame) {
  for (const NormalStress stress : {NormalStress::kRadial, NormalStress::kVertical}) {
    SoilOptions options;
    options.normal_stress = stress;
    // Turned about a node, so that a quarter turn of the grid is one of the body, and aside of it,
    // so that no cell is touched by rounding alone.
    Contact wheel = slipping_wheel();
    const Eigen::Vector2d aside(0.0013, 0.0006);
    wheel.at.head<2>() = aside;
    SoilBed first = bed_of(true, options);
    const Reaction east = press(first, wheel);
    ASSERT_GT(std::abs(east.force.y()), 0.02 * east.force.z());
    for (int quarter = 1; quarter < 4; ++quarter) {
      SoilBed bed = bed_of(true, options);
      wheel.yaw = 0.5 * std::numbers::pi * quarter;
      wheel.at.head<2>() = Eigen::Rotation2Dd(wheel.yaw) * aside;
      expect_alike(east, press(bed, wheel), 0.01, "a quarter turn");
    }
  }
}

TEST(SoilCells, AMirroredBodyMeetsTheMirrorImage) {
  for (const NormalStress stress : {NormalStress::kRadial, NormalStress::kVertical}) {
    SoilOptions options;
    options.normal_stress = stress;
    Contact left = slipping_wheel();
    left.at.head<2>().setZero();
    Contact right = left;
    right.roll = -left.roll;
    right.velocity.y() = -left.velocity.y();
    right.omega.x() = -left.omega.x();
    right.omega.z() = -left.omega.z();
    SoilBed one = bed_of(true, options);
    SoilBed other = bed_of(true, options);
    const Reaction of_left = press(one, left);
    Reaction mirrored = press(other, right);
    mirrored.force.y() = -mirrored.force.y();
    mirrored.torque.x() = -mirrored.torque.x();
    mirrored.torque.z() = -mirrored.torque.z();
    expect_alike(of_left, mirrored, 0.01, "mirrored");
  }
}

TEST(SoilCells, AWheelThatGoesBackwardsMeetsWhatOneMeetsForwards) {
  for (const NormalStress stress : {NormalStress::kRadial, NormalStress::kVertical}) {
    SoilOptions options;
    options.normal_stress = stress;
    Contact forwards = slipping_wheel();
    forwards.at.head<2>().setZero();
    forwards.pitch = 0.0;
    forwards.roll = 0.0;
    Contact backwards = forwards;
    backwards.velocity.x() = -forwards.velocity.x();
    backwards.surface_speed = -forwards.surface_speed;
    backwards.omega.y() = -forwards.omega.y();
    backwards.omega.z() = -forwards.omega.z();
    SoilBed one = bed_of(true, options);
    SoilBed other = bed_of(true, options);
    const Reaction ahead = press(one, forwards);
    Reaction back = press(other, backwards);
    back.force.x() = -back.force.x();
    back.torque.y() = -back.torque.y();
    back.torque.z() = -back.torque.z();
    back.along_surface = -back.along_surface;
    expect_alike(ahead, back, 0.01, "backwards");
  }
}

TEST(SoilCells, TheFirstTouchTakesTheBodysOwnBreadth) {
  // One step only: b is that of the plate, not yet that of the touched area.
  SoilParameters soil = soil_preset("lete_sand");
  soil.k_c = 1e5;
  SoilBed bed(HeightField(kNodes, kNodes, kSpacing_m, true), soil, {});
  Contact plate;
  plate.footprint = Footprint::box({0.1, 0.04, 0.02});
  constexpr double kDepth_m = 0.004;
  plate.at << 0.0, 0.0, 0.01 - kDepth_m;
  const Reaction reaction = press(bed, plate, 1);
  const double bekker = soil.k_c / 0.04 + soil.k_phi;
  const double pressure = bekker * std::pow(kDepth_m, soil.exponent);
  EXPECT_NEAR(reaction.force.z() / reaction.area, pressure, 0.01 * pressure);
}

}  // namespace
}  // namespace screed
