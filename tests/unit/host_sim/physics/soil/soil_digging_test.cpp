// A plate stands in soil at a fixed depth while a belt slips under it: how much it digs, from where
// and to where, against layer times slip times width.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "host_sim/core/constants.h"
#include "host_sim/physics/soil/soil_bed.h"

namespace screed {
namespace {

constexpr double kSpacing_m = 0.005;
constexpr int kNodes = 81;
constexpr double kThickness_m = 0.02;
constexpr double kDepth_m = 0.002;
constexpr double kStep_s = 0.001;
constexpr double kSlip_m_per_s = 0.5;
constexpr double kUnit_m3 = kHeightUnit_m * kSpacing_m * kSpacing_m;

SoilParameters dragged_soil() {
  SoilParameters soil = soil_preset("lete_sand");
  soil.slip_layer_m = 0.0004;
  soil.slip_carry = 0.0;
  soil.compaction = 0.0;
  soil.repose_deg = 60.0;       // what is heaped up stays where it is
  soil.elastic_pa_per_m = 1e5;  // so soft that the plate goes on touching what it digs away
  return soil;
}

struct Plate {
  double length_m = 0.1;
  double width_m = 0.05;
  double yaw_deg = 0.0;
};

/// Heights before and after a second of slip.
struct Dug {
  HeightField before;
  HeightField after;
  VolumeBalance balance;
  double compacted_m3;
  double area_m2;  // that the plate touched

  double volume_m3() const {  // that is missing where the ground has sunk
    double volume = 0.0;
    visit([&](double, double, double lower) { volume += std::max(0.0, lower); });
    return volume;
  }
  void visit(const std::function<void(double x, double y, double lower_m3)>& what) const {
    for (int iy = 0; iy < after.ny(); ++iy) {
      for (int ix = 0; ix < after.nx(); ++ix) {
        const auto units = static_cast<double>(before.node(ix, iy) - after.node(ix, iy));
        what(after.node_x(ix), after.node_y(iy), units * kUnit_m3);
      }
    }
  }
};

/// Presses the plate, lets all shear be mobilised, then lets it slip for `seconds`.
Dug dig(const Plate& plate, const SoilParameters& soil, double seconds, bool bulldozing = true,
        const std::function<double(double, double)>& ground = nullptr, double lug_height_m = 0.0) {
  const HeightField surface =
      HeightField::from_function(kNodes, kNodes, kSpacing_m, false,
                                 [&](double x, double y) { return ground ? ground(x, y) : 0.0; });
  SoilOptions options;
  options.normal_stress = NormalStress::kVertical;
  options.bulldozing = bulldozing;
  options.avalanches = false;
  SoilBed bed(surface, soil, options);
  Footprint footprint = Footprint::box({plate.length_m, plate.width_m, kThickness_m});
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().z() = 0.5 * kThickness_m - kDepth_m;
  pose.linear() =
      Eigen::AngleAxisd(plate.yaw_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  footprint.set_pose(pose);
  FootprintMotion motion;
  motion.mass_kg = std::numeric_limits<double>::infinity();
  motion.lug_height_m = lug_height_m;
  ContactMemory memory;
  const auto step = [&] {
    const TerrainReaction reaction = bed.press(footprint, motion, kStep_s, memory);
    bed.end_step();
    return reaction.area;
  };
  for (int i = 0; i < 5; ++i) step();  // until the area's b has settled
  motion.velocity = kSlip_m_per_s * pose.linear().col(0);
  for (int i = 0; i < 100; ++i) step();  // many times K: all is mobilised
  const HeightField before = bed.surface();
  const VolumeBalance earlier = bed.balance();
  double area = 0.0;
  const auto steps = static_cast<int>(std::lround(seconds / kStep_s));
  for (int i = 0; i < steps; ++i) area = step();
  const VolumeBalance balance = bed.balance();
  return {before, bed.surface(), balance,
          static_cast<double>(balance.compacted - earlier.compacted) * kUnit_m3, area};
}

TEST(SoilDigging, TakesTheLayerTimesTheSlipTimesTheWidth) {
  const SoilParameters soil = dragged_soil();
  for (const Plate& plate : {Plate{0.1, 0.05}, Plate{0.05, 0.1}, Plate{0.1, 0.05, 90.0}}) {
    const Dug dug = dig(plate, soil, 0.2);
    const double expected = soil.slip_layer_m * kSlip_m_per_s * 0.2 * plate.width_m;
    EXPECT_NEAR(dug.volume_m3(), expected, 0.02 * expected) << plate.length_m << plate.yaw_deg;
    EXPECT_EQ(dug.balance.error(), 0);
  }
  // At any yaw the cells at the edges count by their share.
  const Dug turned = dig({0.1, 0.05, 30.0}, soil, 0.2);
  const double expected = soil.slip_layer_m * kSlip_m_per_s * 0.2 * 0.05;
  EXPECT_NEAR(turned.volume_m3(), expected, 0.1 * expected);
}

TEST(SoilDigging, IsAsMuchAtHalfTheSlipAndTwiceTheTimeAndGrowsWithTheLayer) {
  SoilParameters soil = dragged_soil();
  const double once = dig({}, soil, 0.1).volume_m3();
  EXPECT_NEAR(dig({}, soil, 0.2).volume_m3(), 2.0 * once, 0.02 * once);
  soil.slip_layer_m *= 2.0;
  EXPECT_NEAR(dig({}, soil, 0.1).volume_m3(), 2.0 * once, 0.02 * once);
  soil.slip_layer_m = 0.0;
  EXPECT_EQ(dig({}, soil, 0.1).volume_m3(), 0.0);
}

TEST(SoilDigging, HeapsItUpAroundThePlateAsFarAsThePlateIsWide) {
  for (const double yaw_deg : {0.0, 90.0}) {
    const Dug dug = dig({0.1, 0.05, yaw_deg}, dragged_soil(), 0.3);
    double heaped = 0.0;
    double farthest_x = 0.0;
    double farthest_y = 0.0;
    dug.visit([&](double x, double y, double lower) {
      if (lower >= 0.0) return;
      heaped -= lower;
      farthest_x = std::max(farthest_x, std::abs(x));
      farthest_y = std::max(farthest_y, std::abs(y));
    });
    EXPECT_NEAR(heaped, dug.volume_m3(), 1e-9 + 60.0 * kUnit_m3);
    const double along = yaw_deg == 0.0 ? farthest_x : farthest_y;
    const double across = yaw_deg == 0.0 ? farthest_y : farthest_x;
    EXPECT_NEAR(along, 0.05 + 0.05, kSpacing_m) << "half the length and the band";
    EXPECT_NEAR(across, 0.025 + 0.05, kSpacing_m) << "half the width and the band";
  }
}

// Volume times the way it has moved.
TEST(SoilDigging, ADragShareCarriesTheLayerTheWayTheSurfaceSlips) {
  SoilParameters soil = dragged_soil();
  for (const double share : {0.0, 0.3, 0.6}) {
    soil.slip_carry = share;
    for (const double yaw_deg : {0.0, 90.0, 180.0}) {
      const Dug dug = dig({0.1, 0.05, yaw_deg}, soil, 0.3);
      double east = 0.0;
      double north = 0.0;
      dug.visit([&](double x, double y, double lower) {
        east -= lower * x;
        north -= lower * y;
      });
      const double expected = soil.slip_layer_m * share * kSlip_m_per_s * 0.3 * 0.1 * 0.05;
      const double yaw = yaw_deg * std::numbers::pi / 180.0;
      const double tolerance = 0.02 * soil.slip_layer_m * kSlip_m_per_s * 0.3 * 0.1 * 0.05;
      EXPECT_NEAR(east, expected * std::cos(yaw), tolerance) << share << " " << yaw_deg;
      EXPECT_NEAR(north, expected * std::sin(yaw), tolerance) << share << " " << yaw_deg;
      EXPECT_EQ(dug.balance.error(), 0);
    }
  }
}

TEST(SoilDigging, LugsTakeAlongWhatTheyHoldBetweenThem) {
  SoilParameters smooth = dragged_soil();
  smooth.slip_layer_m = 0.0;
  const double once = dig({}, dragged_soil(), 0.1).volume_m3();
  EXPECT_NEAR(dig({}, smooth, 0.1, true, nullptr, 0.0004).volume_m3(), once, 1e-6 * once);
  EXPECT_NEAR(dig({}, dragged_soil(), 0.1, true, nullptr, 0.0003).volume_m3(), once, 1e-6 * once)
      << "the layer is not booked twice";
}

// A plate of 2 kg that slips without going anywhere sinks, and what it presses down comes up behind
// it: volume times way over volume is slip_carry times its length.
TEST(SoilDigging, WhatSinksBySlipGoesAlongWithIt) {
  for (const double share : {0.0, 0.66}) {
    SoilParameters soil = soil_preset("cmu_2022");
    soil.slip_carry = share;
    soil.repose_deg = 60.0;
    SoilOptions options;
    options.avalanches = false;
    SoilBed bed(HeightField(kNodes, kNodes, kSpacing_m, false), soil, options);
    Footprint plate = Footprint::box({0.1, 0.05, kThickness_m});
    ContactMemory memory;
    FootprintMotion motion;
    motion.mass_kg = 2.0;
    double z = 0.5 * kThickness_m;
    const auto run = [&](int steps) {
      for (int i = 0; i < steps; ++i) {
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.translation().z() = z;
        plate.set_pose(pose);
        const TerrainReaction reaction = bed.press(plate, motion, kStep_s, memory);
        bed.end_step();
        motion.velocity.z() += kStep_s * (reaction.force.z() / motion.mass_kg - kGravity_m_per_s2);
        z += kStep_s * motion.velocity.z();
      }
    };
    run(400);
    const HeightField before = bed.surface();
    motion.surface_speed = kSlip_m_per_s;  // its lower side goes backward
    run(400);
    double raised = 0.0;
    double moment = 0.0;
    for (int iy = 0; iy < kNodes; ++iy) {
      for (int ix = 0; ix < kNodes; ++ix) {
        const auto rise = static_cast<double>(bed.surface().node(ix, iy) - before.node(ix, iy));
        raised += std::max(0.0, rise);
        moment -= rise * before.node_x(ix);
      }
    }
    EXPECT_GT(raised * kUnit_m3, 0.2e-6);
    EXPECT_NEAR(moment / raised, share * 0.1, 0.12 * 0.1) << share;
    EXPECT_EQ(bed.balance().error(), 0);
    EXPECT_GE(bed.balance().in_transit, 0);
  }
}

TEST(SoilDigging, ThePatchIsWhatThePlateTouches) {
  // Half of the plate hangs over lower ground: along it, then across it.
  for (const bool along : {true, false}) {
    const auto ground = [&](double x, double y) { return (along ? x : y) > 0.0025 ? -0.01 : 0.0; };
    const Plate square{0.1, 0.1};
    const Dug dug = dig(square, dragged_soil(), 0.3, true, ground);
    EXPECT_NEAR(dug.area_m2, 0.5 * 0.01, 0.1 * 0.01);
    // The touched half is 5 cm by 10 cm: slip along it moves as wide a layer as it is across.
    const double width = along ? 0.1 : 0.05;
    const double expected = dragged_soil().slip_layer_m * kSlip_m_per_s * 0.3 * width;
    EXPECT_NEAR(dug.volume_m3(), expected, 0.12 * expected) << along;
    // It lies around the touched half: the heap's end on the touched side is 2.5 + 2.5 + 5 cm off.
    double least = 0.0;
    double most = 0.0;
    dug.visit([&](double x, double y, double lower) {
      if (lower >= 0.0) return;
      least = std::min(least, along ? x : y);
      most = std::max(most, along ? x : y);
    });
    EXPECT_NEAR(least, -0.05 - 0.05, 0.006) << along;
    EXPECT_NEAR(most, 0.05, 0.009) << along << ": as far from the touched half's edge";
  }
}

TEST(SoilDigging, WhereNothingIsPushedAsideItIsGone) {
  const SoilParameters soil = dragged_soil();
  const Dug dug = dig({}, soil, 0.2, false);
  const double expected = soil.slip_layer_m * kSlip_m_per_s * 0.2 * 0.05;
  EXPECT_NEAR(dug.volume_m3(), expected, 0.02 * expected);
  EXPECT_NEAR(dug.compacted_m3, dug.volume_m3(), 60.0 * kUnit_m3);
  double heaped = 0.0;
  dug.visit([&](double, double, double lower) { heaped += std::max(0.0, -lower); });
  EXPECT_EQ(heaped, 0.0);
  EXPECT_EQ(dug.balance.in_transit, 0);
  EXPECT_EQ(dug.balance.error(), 0);
}

TEST(SoilDigging, LugsTakeNoMoreThanTheyHaveSunkInto) {
  SoilParameters soil = dragged_soil();
  soil.slip_layer_m = 0.0;
  const double shallow = dig({}, soil, 0.01, true, nullptr, 0.001).volume_m3();
  const double deep = dig({}, soil, 0.01, true, nullptr, 0.05).volume_m3();
  // The plate is 2 mm deep, less what it has dug meanwhile.
  EXPECT_GT(deep, 1.2 * shallow);
  EXPECT_LT(deep, 2.0 * shallow);
}

/// What holds a plate back that has sunk by some 10 um under 2 kPa and is dragged on, N.
double shear_of_plate(double lug_height_m, double cohesion_pa) {
  SoilParameters soil = soil_preset("lete_sand");
  soil.cohesion_pa = cohesion_pa;
  const HeightField level(kNodes, kNodes, kSpacing_m, false);
  SoilBed bed(level, soil, SoilOptions{NormalStress::kVertical});
  Footprint plate = Footprint::box({0.1, 0.05, kThickness_m});
  FootprintMotion motion;
  motion.mass_kg = 1.0;
  motion.lug_height_m = lug_height_m;
  ContactMemory memory;
  double height = 0.5 * kThickness_m;
  double rising = 0.0;
  TerrainReaction reaction;
  for (int i = 0; i < 3000; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().z() = height;
    plate.set_pose(pose);
    motion.velocity = {i < 1000 ? 0.0 : 0.05, 0.0, rising};
    reaction = bed.press(plate, motion, kStep_s, memory);
    bed.end_step();
    rising += kStep_s * (reaction.force.z() - 10.0) / motion.mass_kg;
    height += kStep_s * rising;
  }
  return -reaction.force.x();
}

TEST(SoilDigging, CohesionHoldsATreadOnlyAsDeepAsItHasSunk) {
  const double tan_phi = std::tan(31.1 * std::numbers::pi / 180.0);
  EXPECT_NEAR(shear_of_plate(0.0, 1300.0), 1300.0 * 0.005 + 10.0 * tan_phi, 0.3) << "no tread";
  EXPECT_NEAR(shear_of_plate(0.002, 1300.0), 10.0 * 0.8, 0.3) << "rubber on top of the soil";
  EXPECT_NEAR(shear_of_plate(0.002, 0.0), 10.0 * tan_phi, 0.3) << "the soil yields first";
}

TEST(SoilDigging, APlateThatDoesNotSlipDigsNothing) {
  SoilParameters soil = dragged_soil();
  const HeightField level(kNodes, kNodes, kSpacing_m, false);
  SoilBed bed(level, soil, SoilOptions{NormalStress::kVertical});
  Footprint plate = Footprint::box({0.1, 0.05, kThickness_m});
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().z() = 0.5 * kThickness_m + 0.01;  // and does not touch
  plate.set_pose(pose);
  FootprintMotion motion;
  motion.mass_kg = 1.0;
  motion.velocity = kSlip_m_per_s * pose.linear().col(0);
  ContactMemory memory;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(bed.press(plate, motion, kStep_s, memory).area, 0.0);
    bed.end_step();
  }
  EXPECT_EQ(bed.balance().compacted, 0);
  EXPECT_EQ(bed.balance().in_transit, 0);
  for (int iy = 0; iy < kNodes; ++iy) {
    for (int ix = 0; ix < kNodes; ++ix) ASSERT_EQ(bed.surface().node(ix, iy), 0);
  }
}

}  // namespace
}  // namespace screed
