// Parts of a vehicle: the chain's solver, the hull, ODE itself.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

#include "host_sim/core/elementary.h"
#include "host_sim/core/random.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/vehicle/chain_track.h"
#include "host_sim/physics/vehicle/hull.h"
#include "host_sim/physics/vehicle/ode_world.h"

namespace screed {

namespace {

// The cyclic block elimination against Eigen's dense solver.

TEST(ChainSolver, AgreesWithADenseSolver) {
  WorldRandom random(7, "chain");
  const auto number = [&] { return random.uniform(-0.5, 0.5); };
  for (const int pins : {3, 4, 5, 54}) {
    const auto size = static_cast<size_t>(pins);
    ChainSolver solver(size);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(2 * pins, 2 * pins);
    Eigen::VectorXd right(2 * pins);
    for (int i = 0; i < pins; ++i) {
      const int j = (i + 1) % pins;
      Eigen::Matrix2d link;
      link << number(), number(), number(), number();
      solver.next[static_cast<size_t>(i)] = link;
      dense.block<2, 2>(2 * i, 2 * j) += link;
      dense.block<2, 2>(2 * j, 2 * i) += link.transpose();
      Eigen::Matrix2d own;
      own << number(), number(), number(), number();
      own = own * own.transpose() + 3.0 * Eigen::Matrix2d::Identity();  // dominates: definite
      solver.diagonal[static_cast<size_t>(i)] = own;
      dense.block<2, 2>(2 * i, 2 * i) += own;
      right.segment<2>(2 * i) << number(), number();
      solver.right[static_cast<size_t>(i)] = right.segment<2>(2 * i);
    }
    const Eigen::VectorXd expected = dense.ldlt().solve(right);
    const std::vector<Eigen::Vector2d>& found = solver.solve();
    for (int i = 0; i < pins; ++i) {
      EXPECT_LT((found[static_cast<size_t>(i)] - expected.segment<2>(2 * i)).norm(), 1e-12)
          << "pin " << i << " of " << pins;
    }
  }
}

// What a body has beside its running gear, on soft ground.

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
  const CarrierMotion at_rest{Eigen::Vector3d::Zero(),
                              Eigen::Matrix3d::Identity(),
                              Eigen::Vector3d::Zero(),
                              Eigen::Vector3d::Zero(),
                              1.2,
                              Eigen::Matrix3d::Zero()};
  CarrierMotion motion = at_rest;
  motion.origin.z() = 0.02 - 0.0005;
  motion.velocity.x() = 0.1;
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

// What ODE and other foreign libraries compute with.

/// The function that a shared library of this program gets by this name.
template <typename Call>
Call for_libraries(const char* name) {
  return reinterpret_cast<Call>(dlsym(RTLD_DEFAULT, name));
}

TEST(OdeWorld, LibrariesComputeWithOurFunctions) {
  using Unary = double (*)(double);
  struct Function {
    const char* name;
    Unary ours;
  };
  const Function functions[] = {{"sin", portable::sin},
                                {"cos", portable::cos},
                                {"asin", portable::asin},
                                {"acos", portable::acos}};
  const OdeWorld world;
  WorldRandom random(1, "arguments");
  for (int i = 0; i < 2000; ++i) {
    const double x = random.uniform(-1.0, 1.0);
    for (const Function& function : functions) {
      ASSERT_EQ(for_libraries<Unary>(function.name)(x), function.ours(x)) << function.name << x;
    }
    const double y = random.uniform(-1.0, 1.0);
    ASSERT_EQ(for_libraries<double (*)(double, double)>("atan2")(y, x), portable::atan2(y, x));
    double sine = 0.0;
    double cosine = 0.0;
    for_libraries<void (*)(double, double*, double*)>("sincos")(x, &sine, &cosine);
    ASSERT_EQ(sine, portable::sin(x));
    ASSERT_EQ(cosine, portable::cos(x));
  }
}

}  // namespace

}  // namespace screed
