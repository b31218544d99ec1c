// What a body has beside its running gear, on soft ground.
#include "host_sim/physics/vehicle/hull.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "host_sim/physics/soil/soil_bed.h"

namespace screed {
namespace {

// A hull is smooth: cohesive soil does not stick to it, and holds it by no more than Coulomb's
// friction of the hull.
TEST(Hull, SlidesOverCohesiveSoilByItsOwnFriction) {
  constexpr double kFriction = 0.3;
  constexpr double kStep_s = 0.001;
  SoilBed bed(HeightField::flat(1.0, 0.01), soil_preset("lete_sand"));
  ASSERT_GT(bed.soil().cohesion_pa, 1000.0);
  Hull hull;
  Shape belly;
  belly.geometry = Box{{0.2, 0.1, 0.04}};
  hull.add(belly, Eigen::Isometry3d::Identity());
  hull.close(kFriction, 1.2);
  CarrierMotion motion{{0.0, 0.0, 0.02 - 0.0005}, Eigen::Matrix3d::Identity(), {0.1, 0.0, 0.0}, {}};
  motion.omega.setZero();
  BodyMemory memory;
  TerrainReaction reaction;
  for (int i = 0; i < 1000; ++i) {  // ten times as far as shears this soil
    motion.origin.x() += motion.velocity.x() * kStep_s;
    std::vector<FootprintContact> contacts;
    hull.add_footprint_contacts(bed, motion, contacts);
    ASSERT_EQ(contacts.size(), 1U);
    PressingBody body;
    body.mass_kg = std::numeric_limits<double>::infinity();
    body.centre = motion.origin;
    body.velocity = motion.velocity;
    bed.press(body, contacts, kStep_s, memory);
    bed.end_step();
    reaction = contacts[0].reaction;
  }
  ASSERT_GT(reaction.normal_load, 1.0);
  EXPECT_LT(-reaction.force.x(), 1.01 * kFriction * reaction.normal_load);
  EXPECT_GT(-reaction.force.x(), 0.9 * kFriction * reaction.normal_load);
}

}  // namespace
}  // namespace screed
