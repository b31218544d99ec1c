// The kernels of contact with soil: the same bits with every set of instructions, and the values of
// the scalar laws that they compute eight at a time.
#include "host_sim/physics/kernels/kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "host_sim/core/random.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/soil/soil_grid.h"
#include "host_sim/physics/soil/soil_laws.h"
#include "host_sim/physics/terrain/footprint.h"
#include "host_sim/physics/terrain/shear_field.h"

namespace screed {
namespace {

/// What a robot's belt, box and wheel leave behind that drive, turn and slip over rough soil.
struct Trace {
  std::vector<double> forces;
  std::vector<Height> heights;
};

Trace drive(InstructionSet set) {
  SoilParameters soil = soil_preset("cmu_2022");  // with all that a soil can have
  soil.damping_pa_s_per_m = 300.0;
  soil.slip_layer_m = 0.002;
  soil.slip_carry = 0.7;
  soil.compaction = 0.2;
  SoilOptions options;
  options.instructions = set;
  SoilBed bed(HeightField::from_function(
                  121, 101, 0.00625, true,
                  [](double x, double y) { return 0.01 * std::sin(17.0 * x) * std::cos(9.0 * y); }),
              soil, options);
  Footprint belt = Footprint::track(0.06, 0.03, 0.03);
  Footprint wheel = Footprint::wheel(0.04, 0.025);
  Footprint box = Footprint::box({0.08, 0.06, 0.02});
  std::array<ContactMemory, 3> memories;
  Trace trace;
  constexpr double kStep = 0.002;
  for (int i = 0; i < 300; ++i) {
    const double t = i * kStep;
    const Eigen::AngleAxisd turned(0.4 + 0.9 * t, Eigen::Vector3d::UnitZ());
    const Eigen::AngleAxisd tilted(0.1 * std::sin(8.0 * t), Eigen::Vector3d(0.6, 0.8, 0.0));
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = (turned * tilted).toRotationMatrix();
    PressingBody body;
    body.mass_kg = std::numeric_limits<double>::infinity();
    body.velocity = {0.1, 0.02, -0.01 * std::cos(8.0 * t)};
    body.omega = {0.0, 0.0, 0.9};
    body.centre = {-0.1 + 0.1 * t, 0.02 * t, 0.03};
    const std::array<Eigen::Vector3d, 3> places = {Eigen::Vector3d(0.0, 0.07, -0.004),
                                                   Eigen::Vector3d(0.0, -0.07, 0.006),
                                                   Eigen::Vector3d(0.02, 0.0, -0.022)};
    std::array<Footprint*, 3> footprints = {&belt, &wheel, &box};
    std::array<FootprintContact, 3> contacts;
    for (size_t k = 0; k < 3; ++k) {
      pose.translation() = body.centre + pose.linear() * places[k];
      footprints[k]->set_pose(pose);
      contacts[k].footprint = footprints[k];
      contacts[k].memory = &memories[k];
      contacts[k].motion.surface_speed = 0.16;
      contacts[k].motion.slip = 0.375;
    }
    BodyMemory memory;
    bed.press(body, contacts, kStep, memory);
    bed.end_step();
    for (const FootprintContact& contact : contacts) {
      for (const double part :
           {contact.reaction.force.x(), contact.reaction.force.y(), contact.reaction.force.z(),
            contact.reaction.torque.x(), contact.reaction.torque.z(), contact.reaction.area}) {
        trace.forces.push_back(part);
      }
    }
  }
  const size_t nodes =
      static_cast<size_t>(bed.surface().nx()) * static_cast<size_t>(bed.surface().ny());
  trace.heights.assign(bed.surface().heights(), bed.surface().heights() + nodes);
  return trace;
}

TEST(Kernels, EverySetOfInstructionsGivesTheSameBits) {
  const Trace baseline = drive(InstructionSet::kBaseline);
  EXPECT_GT(*std::max_element(baseline.forces.begin(), baseline.forces.end()), 1.0)
      << "nothing was pressed";
  for (const InstructionSet set : instruction_sets()) {
    const Trace trace = drive(set);
    EXPECT_EQ(trace.heights, baseline.heights) << name_of(set);
    ASSERT_EQ(trace.forces.size(), baseline.forces.size());
    EXPECT_EQ(std::memcmp(trace.forces.data(), baseline.forces.data(),
                          baseline.forces.size() * sizeof(double)),
              0)
        << name_of(set);
  }
}

TEST(Kernels, TheBestSetIsTheLastThatTheProcessorHas) {
  EXPECT_EQ(best_kernels().set, instruction_sets().back());
  for (const InstructionSet set : instruction_sets()) EXPECT_EQ(kernels_for(set).set, set);
}

TEST(Kernels, SinkageIsDividedAsCellsDo) {
  WorldRandom random(7, "kernels");
  for (const InstructionSet set : instruction_sets()) {
    for (int trial = 0; trial < 500; ++trial) {
      CellBlock block{};
      std::vector<double> share(kLanes);
      std::vector<double> passed(kLanes, -1.0);
      std::vector<CellHistory> histories(kLanes);
      for (size_t i = 0; i < kLanes; ++i) {
        const double before = trial % 3 == 0 ? 0.0 : random.uniform();
        share[i] = trial % 5 == 0 ? before : random.uniform() + 1e-3;
        histories[i].keep(before, {0.002 * random.uniform(), 0.001 * random.uniform()});
        if (random.uniform() < 0.7) histories[i].touch(4);
        block.active[i] = 1.0;
        block.sunk[i] = 0.005 * random.uniform();
        block.fresh[i] = histories[i].is_contact_new(5) ? 1.0 : 0.0;
        block.covered_before[i] = histories[i].covered();
        block.old_sinkage[i] = histories[i].old_sinkage();
        block.beside[i] = histories[i].beside();
      }
      SurfacePoints points{};
      points.share = share.data();
      points.passed = passed.data();
      kernels_for(set).divide_cells(&block, 1, points, 1);
      for (size_t i = 0; i < kLanes; ++i) {
        if (share[i] == 0.0) continue;  // not below the body
        const SinkageDivision part = histories[i].divide(share[i], block.sunk[i], 5);
        EXPECT_NEAR(block.old_sinkage[i], part.old_sinkage, 1e-15);
        EXPECT_NEAR(block.beside[i], part.beside, 1e-15);
        EXPECT_EQ(block.active[i], 1.0);
        EXPECT_EQ(block.covered[i], share[i]);
      }
    }
  }
}

TEST(Kernels, ShearFollowsTheLawOfOnePlace) {
  const RunContour belt{0.1, 0.0, 0.03, 0.02};
  WorldRandom random(11, "kernels");
  for (const InstructionSet set : instruction_sets()) {
    ShearField field;
    ShearState state;
    for (int i = 0; i < 400; ++i) {
      RunMotion motion;
      motion.velocity = {0.2 * random.uniform() - 0.1, 0.2 * random.uniform() - 0.1, 0.0};
      motion.omega.setZero();
      const double dt = i % 40 == 0 ? 0.05 : 0.001;  // some slides are long
      field.advance(belt, motion, -0.1, 0.1, 0.01, 0.0, dt, kernels_for(set));
      state.slide(motion.velocity.x() * dt / 0.01, motion.velocity.y() * dt / 0.01);
      const ShearField::Value value = field.at(0.03, 0.0);
      ASSERT_NEAR(value.along, state.along, 1e-12) << i;
      ASSERT_NEAR(value.across, state.across, 1e-12) << i;
      ASSERT_NEAR(value.sliding, motion.velocity.norm(), 1e-15) << i;
    }
  }
}

TEST(Kernels, PowersAreThoseOfTheTable) {
  const PowerTable table(1.1);
  const PowerLines lines = table.lines();
  for (const double z : {0.0, 1e-12, 3e-8, 1e-5, 0.0021, 0.03, 0.9, 1.0, 7.0}) {
    // As the kernels find the line.
    uint64_t bits = 0;
    std::memcpy(&bits, &z, sizeof bits);
    const double index = std::clamp(
        static_cast<double>(bits >> lines.dropped_bits) - lines.first + 1.0, 0.0, lines.last);
    const double* line = lines.lines + 2 * static_cast<size_t>(index);
    EXPECT_EQ(line[0] + z * line[1], table.power(z)) << z;
  }
}

TEST(Kernels, HeightsAboveALineAreFoundWhereverTheyAre) {
  for (const InstructionSet set : instruction_sets()) {
    const Kernels& kernels = kernels_for(set);
    for (size_t count = 0; count < 40; ++count) {
      std::vector<int32_t> heights(count + 1, 100);
      heights[count] = 1000;  // one too far
      EXPECT_EQ(kernels.above_line(heights.data(), count, 0.5, 50.0, 0.0).end, 0U) << count;
      for (size_t i = 0; i < count; ++i) {
        for (size_t j = i; j < count; ++j) {
          std::vector<int32_t> bumpy(count, 100);
          bumpy[i] = bumpy[j] = 101;
          const AboveLine found = kernels.above_line(bumpy.data(), count, 0.5, 50.0, 0.0);
          EXPECT_EQ(found.first, i);
          EXPECT_EQ(found.end, j + 1);
        }
        std::vector<int32_t> bumpy(count, 100);
        bumpy[i] = 101;
        const AboveLine rising = kernels.above_line(bumpy.data(), count, 0.5, 50.0, 0.1);
        EXPECT_EQ(rising.end, i < 5 ? i + 1 : 0) << i;
      }
    }
  }
}

}  // namespace
}  // namespace screed
