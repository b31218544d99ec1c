// Cells of soil: their history, their numbers, and that the grid does not show.
#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "host_sim/core/random.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/soil/soil_grid.h"

namespace screed {

namespace {

// How a cell divides its plastic sinkage between what a body covers and the rest.

constexpr double kSunk_m = 0.004;
constexpr double kTolerance_m = 1e-9;  // of the floats it keeps, a ten-millionth of the sinkage

/// A cell on which a body has stood in the last step, having covered `covered` from the start.
CellHistory pressed(double covered, double sunk) {
  CellHistory history;
  history.keep(covered, history.divide(covered, sunk, 1));
  history.touch(1);
  return history;
}

TEST(CellHistory, ABodyOnFreshSoilFindsNothingPressed) {
  const SinkageDivision part = CellHistory{}.divide(0.4, 0.0, 1);
  EXPECT_EQ(part.old_sinkage, 0.0);
  EXPECT_EQ(part.beside, 0.0);
  EXPECT_EQ(part.under(0.4, 0.0), 0.0);
}

TEST(CellHistory, WhatIsPressedInAContactIsUnderTheBody) {
  const CellHistory history = pressed(0.25, 0.0);
  // It has sunk since, the coverage is the same.
  const SinkageDivision part = history.divide(0.25, kSunk_m, 2);
  EXPECT_EQ(part.old_sinkage, 0.0);
  EXPECT_EQ(part.beside, 0.0);
  EXPECT_DOUBLE_EQ(part.under(0.25, kSunk_m), 4.0 * kSunk_m);
}

TEST(CellHistory, WhatABodyLeavesKeepsItsSinkage) {
  const CellHistory history = pressed(0.8, 0.0);
  const SinkageDivision part = history.divide(0.2, kSunk_m, 2);
  const double under = kSunk_m / 0.8;
  EXPECT_NEAR(part.under(0.2, kSunk_m), under, kTolerance_m);
  EXPECT_NEAR(part.beside, 0.6 * under, kTolerance_m);
  EXPECT_EQ(part.old_sinkage, 0.0);
}

TEST(CellHistory, WhatABodyReachesHasTheMeanOfTheRest) {
  CellHistory history = pressed(0.8, 0.0);
  history.keep(0.2, history.divide(0.2, kSunk_m, 2));
  history.touch(2);
  const double rest = 0.6 * kSunk_m / 0.8 / 0.8;  // 0.6 of the cell was left, in 0.8 of it
  const SinkageDivision part = history.divide(0.7, kSunk_m, 3);
  EXPECT_NEAR(part.beside, 0.3 * rest, kTolerance_m);
  EXPECT_NEAR(part.old_sinkage, 0.5 * rest / 0.7,
              kTolerance_m);  // of the part it had, nothing was old
  const SinkageDivision all = history.divide(1.0, kSunk_m, 3);
  EXPECT_NEAR(all.beside, 0.0, kTolerance_m);
  EXPECT_NEAR(all.under(1.0, kSunk_m), kSunk_m, kTolerance_m);
}

TEST(CellHistory, ANewContactFindsTheOldRutBelowIt) {
  CellHistory history = pressed(0.5, 0.0);
  history.keep(0.5, history.divide(0.5, kSunk_m, 2));
  history.touch(2);
  // Step 3 was without a body.
  for (const double covered : {0.5, 0.9}) {
    const SinkageDivision part = history.divide(covered, kSunk_m, 4);
    EXPECT_NEAR(part.old_sinkage, kSunk_m / covered, kTolerance_m) << covered;
    EXPECT_NEAR(part.beside, 0.0, kTolerance_m) << covered;
  }
  const SinkageDivision part = history.divide(0.1, kSunk_m, 4);
  EXPECT_NEAR(part.old_sinkage, kSunk_m / 0.5, kTolerance_m);
  EXPECT_NEAR(part.beside, 0.8 * kSunk_m, kTolerance_m);
}

TEST(CellHistory, AContactGoesOnFromStepToStepUntilItIsReleased) {
  CellHistory history;
  EXPECT_TRUE(history.is_contact_new(1));
  history.touch(7);
  EXPECT_FALSE(history.is_contact_new(7));
  EXPECT_FALSE(history.is_contact_new(8));
  EXPECT_TRUE(history.is_contact_new(9));
  history.release();
  EXPECT_TRUE(history.is_contact_new(8));
}

// A body that covers more and less of a cell, and does not sink: parts stay parts of one sum, none
// becomes negative, and what was there before the contact is all that is there.
TEST(CellHistory, DividingNeitherMakesNorLosesSinkage) {
  WorldRandom random(3, "coverage");
  for (int run = 0; run < 50; ++run) {
    CellHistory history;
    history.keep(0.6, {kSunk_m / 0.6, 0.0});  // a rut over six tenths, made by another body
    for (uint32_t step = 3; step < 40; ++step) {
      const double covered = random.uniform(0.05, 1.0);
      const SinkageDivision part = history.divide(covered, kSunk_m, step);
      ASSERT_NEAR(covered * part.old_sinkage + part.beside, kSunk_m, kTolerance_m) << step;
      ASSERT_NEAR(part.old_sinkage, part.under(covered, kSunk_m), kTolerance_m / 0.05) << step;
      ASSERT_GE(part.beside, -kTolerance_m) << step;
      ASSERT_LE(part.beside, kSunk_m + kTolerance_m) << step;
      history.keep(covered, part);
      history.touch(step);
    }
  }
}

// Cells of soil by number and by place.

TEST(SoilGrid, ACellIsFoundAcrossTheEdgeOfAFieldThatRepeatsAndNotOfOneThatDoesNot) {
  const SoilGrid wrapped(HeightField(5, 5, 0.01, true), 0);
  const auto number = [&](int ix, int iy) {
    GridNode at{0, ix, iy};
    EXPECT_TRUE(wrapped.find(at));
    EXPECT_EQ(at.node, wrapped.node(ix, iy));
    return at.node;
  };
  EXPECT_EQ(number(-1, 0), 4U);
  EXPECT_EQ(number(5, -1), 20U);
  EXPECT_EQ(number(-6, 12), 14U);
  const SoilGrid edged(HeightField(5, 5, 0.01, false), 0);
  GridNode corner{0, 4, 4};
  EXPECT_TRUE(edged.find(corner));
  EXPECT_EQ(corner.node, 24U);
  for (const auto& [ix, iy] : {std::pair{-1, 0}, {5, 0}, {0, -1}, {0, 5}}) {
    GridNode outside{0, ix, iy};
    EXPECT_FALSE(edged.find(outside)) << ix << " " << iy;
  }
}

TEST(SoilGrid, AHeightIsSetThroughAPlaceThatTheFieldRepeats) {
  SoilGrid grid(HeightField(5, 4, 0.01, true), 0);
  grid.set_height(grid.place(-1, 6), 30);
  EXPECT_EQ(grid.surface().node(4, 2), 30);
  grid[14].sunk = 12;
  EXPECT_EQ(grid.reference(14), 42);
}

// The grid must not show: what a body meets is the same across the seam of a bed that repeats, in
// all four directions of the grid, and mirrored; at the edge of a bed nothing is met beyond it.

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

TEST(SoilCells, ABoxAcrossTheSeamOfABedThatRepeatsMeetsTheSame) {
  Contact box;
  box.footprint = Footprint::box({0.1, 0.06, 0.02});
  box.at.z() = 0.01 - 0.003;
  SoilBed middle = bed_of(true);
  const Reaction here = press(middle, box);
  ASSERT_GT(here.force.z(), 1.0);
  for (const Eigen::Vector2d& seam : {Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(0.0, -1.0)}) {
    SoilBed bed = bed_of(true);
    Contact moved = box;
    moved.at.head<2>() += 0.5 * kNodes * kSpacing_m * seam;
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
