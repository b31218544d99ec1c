// The stand-in's ground: Bekker's depth, digging, and a volume that stays.
#include "host_sim/standin/belt_ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "host_sim/core/constants.h"
#include "host_sim/core/random.h"

namespace screed {
namespace {

HeightField flat() {
  return HeightField::flat(1.0, 0.02);
}

std::int64_t lowered(const HeightField& before, const HeightField& after) {
  std::int64_t sum = 0;
  for (int iy = 0; iy < before.ny(); ++iy) {
    for (int ix = 0; ix < before.nx(); ++ix) {
      sum += std::max<std::int64_t>(0, before.node(ix, iy) - after.node(ix, iy));
    }
  }
  return sum;
}

SoilParameters digging(double slip_layer_m) {
  SoilParameters soil = soil_preset("viper");
  soil.slip_layer_m = slip_layer_m;
  return soil;
}

BeltShear slipping(double forward_m) {
  BeltShear shear;
  shear.forward_m = forward_m;
  shear.length_m = std::abs(forward_m);
  shear.patch_m.fill(shear.length_m);
  return shear;
}

TEST(BeltStrideRecorder, AStrideIsTheSumOfItsFramesAndItsSpeedUpTheirs) {
  BeltStrideRecorder recorder({1.0, 2.0, 0.5});
  BeltShear left = slipping(0.001);
  left.slid_m = 0.002;
  left.moved_m = 0.003;
  const BeltShear right = slipping(-0.004);
  PlanarPose pose{1.0, 2.0, 0.5};
  // From standing to 0.1 m/s, 1 mm a frame, within 50 ms.
  const auto stride = [&](double last_m) {
    for (int frame = 1; frame <= kBeltStrideFrames; ++frame) {
      const FrameMotion motion{frame == kBeltStrideFrames ? last_m : 0.0005, 0.0, 0.0};
      pose.move(motion);
      recorder.add_frame(motion, {left, right});
    }
    return recorder.take(pose);
  };
  const BeltStride first = stride(0.001);
  EXPECT_NEAR(first.acceleration_m_per_s2, 2.0, 1e-9);
  EXPECT_NEAR(first.motion.forward_m, 0.003, 1e-12);
  EXPECT_NEAR(first.motion.sideways_m, 0.0, 1e-12);
  EXPECT_NEAR(first.shear[0].forward_m, 0.005, 1e-12);
  EXPECT_NEAR(first.shear[0].slid_m, 0.010, 1e-12);
  EXPECT_NEAR(first.shear[0].moved_m, 0.015, 1e-12);
  EXPECT_NEAR(first.shear[1].forward_m, -0.020, 1e-12);
  EXPECT_NEAR(first.shear[1].length_m, 0.020, 1e-12);
  EXPECT_NEAR(first.shear[1].patch_m[2], 0.020, 1e-12);
  // The next one begins where it ended: as fast, nothing sheared.
  const BeltStride second = stride(0.001);
  EXPECT_NEAR(second.acceleration_m_per_s2, 0.0, 1e-9);
  EXPECT_NEAR(second.motion.forward_m, 0.003, 1e-12);
  EXPECT_NEAR(second.shear[0].forward_m, 0.005, 1e-12);
  EXPECT_NEAR(stride(0.0).acceleration_m_per_s2, -2.0, 1e-9) << "to a stop";
}

TEST(BeltGround, SinksUntilBekkerSupportsTheWeight) {
  const TrackGeometry tracks;
  for (const char* name : {"viper", "lete_sand", "soft"}) {
    const SoilParameters soil = soil_preset(name);
    BeltGround ground(HeightField::flat(1.0, 0.005), soil, tracks, 1);
    ground.place(0, {});
    // Straight run and what of the wheels touches: the pressure on the straight part, with its own
    // depth, and less on the arcs. Bounds: all on the straight part, or on the arcs' chords too.
    const double bekker = soil.k_c / tracks.width_m + soil.k_phi;
    const double weight = tracks.mass_kg * kGravity_m_per_s2;
    const auto depth = [&](double length_m) {
      return std::pow(weight / (2.0 * tracks.width_m * length_m) / bekker, 1.0 / soil.exponent);
    };
    const double deepest = depth(2.0 * tracks.half_length_m);
    const double chord = std::sqrt(2.0 * tracks.radius_m * deepest);
    const double least = depth(2.0 * (tracks.half_length_m + chord));
    EXPECT_GT(-ground.plane(0).height_m, 0.95 * least) << name;
    EXPECT_LT(-ground.plane(0).height_m, 1.05 * deepest) << name;
    EXPECT_NEAR(ground.plane(0).forward, 0.0, 1e-3) << name;
    EXPECT_NEAR(ground.plane(0).left, 0.0, 1e-3) << name;
  }
}

// A robot that drives straight on leaves the ruts that Bekker's depth says, whatever part of a cell
// its belts cover.
TEST(BeltGround, AStraightRutIsAsDeepAsTheBeltsStand) {
  for (const double aside_m : {0.0, 0.004, 0.01}) {
    for (const double heading_rad : {0.0, 0.3, 0.785}) {
      const TrackGeometry tracks;
      SoilParameters soil = soil_preset("viper");
      soil.compaction = 1.0;  // what leaves the ruts is booked
      BeltGround ground(HeightField::flat(2.0, 0.02), soil, tracks, 1);
      PlanarPose pose{-0.6 * std::cos(heading_rad), -0.6 * std::sin(heading_rad) + aside_m,
                      heading_rad};
      ground.place(0, pose);
      const double distance_m = 1.2;
      constexpr int kStrides = 120;
      for (int i = 0; i < kStrides; ++i) {
        BeltStride stride;
        stride.motion.forward_m = distance_m / kStrides;
        pose.move(stride.motion);
        stride.pose = pose;
        ground.press(0, stride);
        ground.end_stride();
      }
      const double edge = ground.surface().spacing_m();
      const double volume =
          static_cast<double>(ground.balance().compacted) * kHeightUnit_m * edge * edge;
      const double area = 2.0 * tracks.width_m * (distance_m + 2.0 * tracks.half_length_m);
      const double depth = 0.5 * (ground.sinkage_m(0, 0) + ground.sinkage_m(0, 1));
      EXPECT_NEAR(volume / area, depth, 0.2 * depth) << aside_m << " m, " << heading_rad;
    }
  }
}

TEST(BeltGround, CarriesTheWeightInShares) {
  const TrackGeometry tracks;
  BeltGround ground(HeightField::ramp(1.0, 0.02, 10.0), soil_preset("viper"), tracks, 1);
  ground.place(0, {});
  double sum = 0.0;
  for (const auto& belt : ground.support(0).load) {
    for (const double load : belt) sum += load;
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(std::atan(ground.support(0).forward), 10.0 * 3.14159265 / 180.0, 0.02);
  const auto& left = ground.support(0).load[0];
  EXPECT_GT(left[2], left[0]);  // it leans on what is downhill
}

/// Where the ground carries a robot, ahead of its middle: from the shares of its belts' thirds. Of
/// a pressure that grows evenly along a belt that is 8/9 of it: thirds know (1/3)^2 + (1/3)^2 of
/// L^3 / 3, the belt knows L^3 / 12.
double carried_at_m(const BeltSupport& support, const TrackGeometry& tracks) {
  const double third_m = 2.0 * tracks.half_length_m / 3.0;
  return third_m *
         (support.load[0][0] + support.load[1][0] - support.load[0][2] - support.load[1][2]);
}

// The centre of mass is h above the ground: a robot that speeds up at a leans back, as it would on
// a slope of a / g, and is carried h a / g behind its middle; one that brakes leans forward.
TEST(BeltGround, ARobotThatSpeedsUpLeansBack) {
  TrackGeometry tracks;
  tracks.mass_height_m = 0.08;
  const auto lean = [&](double slope_deg, double acceleration_m_per_s2) {
    BeltGround ground(HeightField::ramp(1.0, 0.005, slope_deg), soil_preset("viper"), tracks, 1);
    ground.place(0, {});
    for (int i = 0; i < 20; ++i) {
      ground.press(0, {{}, {}, {}, acceleration_m_per_s2});
      ground.end_stride();
    }
    return std::pair(carried_at_m(ground.support(0), tracks), ground.plane(0).forward);
  };
  const auto [level_at, level_pitch] = lean(0.0, 0.0);
  EXPECT_NEAR(level_at, 0.0, 1e-4);
  EXPECT_NEAR(level_pitch, 0.0, 1e-4);
  for (const double acceleration : {1.5, -1.5}) {
    const double expected = -8.0 / 9.0 * tracks.mass_height_m * acceleration / kGravity_m_per_s2;
    const auto [at, pitch] = lean(0.0, acceleration);
    EXPECT_NEAR(at, expected, 0.2 * std::abs(expected)) << acceleration;
    EXPECT_GT(pitch * acceleration, 0.0) << "nose up where it speeds up";
    // A slope as steep does the same, and takes the other way round away what soil keeps no trace
    // of.
    const double slope = acceleration / kGravity_m_per_s2;
    const double slope_deg = std::atan(slope) * 57.29578;
    EXPECT_NEAR(lean(slope_deg, 0.0).first, expected, 0.25 * std::abs(expected));
    EXPECT_NEAR(lean(slope_deg, -acceleration).first, 0.0, 0.25 * std::abs(expected));
  }
}

// Downhill belts carry more: the difference of their shares times half the tread is h tan(slope);
// and where the mass is ahead, the front of both does.
TEST(BeltGround, TheWeightIsCarriedBelowTheCentreOfMass) {
  TrackGeometry tracks;
  tracks.mass_height_m = 0.08;
  constexpr double kSlope_deg = 12.0;
  BeltGround across(HeightField::ramp(1.0, 0.005, kSlope_deg), soil_preset("viper"), tracks, 1);
  across.place(0, {0.0, 0.0, 0.5 * std::numbers::pi});  // the ground rises to the right
  double right = 0.0;
  for (const double load : across.support(0).load[1]) right += load;
  const double slope = -across.plane(0).left;
  EXPECT_NEAR(slope, std::tan(kSlope_deg / 57.29578), 0.05) << "it sinks deeper downhill";
  const double expected = tracks.mass_height_m * slope;
  EXPECT_NEAR((1.0 - 2.0 * right) * tracks.half_tread_m, expected, 0.25 * expected);
  tracks.mass_ahead_m = 0.01;
  BeltGround level(HeightField::flat(1.0, 0.005), soil_preset("viper"), tracks, 1);
  level.place(0, {});
  EXPECT_NEAR(carried_at_m(level.support(0), tracks), 8.0 / 9.0 * 0.01, 0.002);
}

// A belt that slips on the spot sinks until the soil bears it at slip_bearing of its pressure, and
// by no more than it slips.
TEST(BeltGround, SlipSinksUntilTheSoilBearsItByLess) {
  const TrackGeometry tracks;
  SoilParameters soil = digging(0.0);
  const auto standing = [&](double k_phi) {
    SoilParameters other = soil;
    other.k_phi = k_phi;
    BeltGround ground(HeightField::flat(1.0, 0.01), other, tracks, 1);
    ground.place(0, {});
    return ground.plane(0).height_m;
  };
  SoilParameters sinking = soil;
  sinking.slip_bearing = 0.4;
  BeltGround ground(HeightField::flat(1.0, 0.01), sinking, tracks, 1);
  ground.place(0, {});
  const auto slip = [&](double slid_m) {
    BeltStride slips;
    for (BeltShear& shear : slips.shear) shear.patch_flow_m.fill(slid_m);
    const double before = ground.plane(0).height_m;
    ground.press(0, slips);
    ground.end_stride();
    return before - ground.plane(0).height_m;
  };
  EXPECT_NEAR(ground.plane(0).height_m, standing(soil.k_phi), 1e-4);
  for (int i = 0; i < 200; ++i) EXPECT_LE(slip(1e-4), 1.3e-4);  // with what springs back
  EXPECT_NEAR(ground.plane(0).height_m / standing(0.4 * soil.k_phi), 1.0, 0.03);
  // Without slip it stays where it is.
  EXPECT_NEAR(slip(0.0), 0.0, 1e-4);
}

// Contact ends where the arcs of the wheels leave the soil, half a cell more at each end: half
// length and chord sqrt(2 r z - z^2) of sinkage z, ahead and behind.
TEST(BeltGround, ContactEndsWhereTheWheelsLeaveTheGround) {
  const TrackGeometry tracks;
  constexpr double kCell_m = 0.005;
  for (const char* name : {"viper", "soft"}) {
    SoilParameters soil = soil_preset(name);
    soil.compaction = 1.0;  // nothing is laid down ahead
    BeltGround ground(HeightField::flat(1.0, kCell_m), soil, tracks, 1);
    ground.place(0, {});
    const double z = -ground.plane(0).height_m;
    const double end_m = tracks.half_length_m + std::sqrt(z * (2.0 * tracks.radius_m - z));
    for (const std::size_t side : {0U, 1U}) {
      EXPECT_NEAR(ground.support(0).front.at(side), end_m, 0.51 * kCell_m) << name;
      EXPECT_NEAR(ground.support(0).rear.at(side), -end_m, 0.51 * kCell_m) << name;
    }
  }
  // Over an edge the belts end in the air, whichever end it is: 0.5 m ahead, or 0.5 m behind.
  for (const double way : {1.0, -1.0}) {
    BeltGround ground(HeightField::flat(1.0, kCell_m), soil_preset("viper"), tracks, 1);
    ground.place(0, {way * 0.46, 0.0, 0.0});
    const BeltSupport& support = ground.support(0);
    for (const std::size_t side : {0U, 1U}) {
      EXPECT_NEAR(way > 0.0 ? support.front.at(side) : -support.rear.at(side), 0.04, kCell_m);
      EXPECT_GT(way > 0.0 ? -support.rear.at(side) : support.front.at(side),
                tracks.half_length_m - kCell_m);
    }
  }
}

TEST(BeltGround, KeepsTheVolumeToTheLastUnitWhateverRobotsDo) {
  for (const char* name : {"gravel", "soft", "clay"}) {
    SoilParameters soil = soil_preset(name);
    soil.slip_layer_m = 0.002;
    BeltGround ground(HeightField::ramp(1.0, 0.02, 15.0), soil, TrackGeometry{}, 2);
    WorldRandom random(7, "belt ground");
    const auto part = [&] { return random.next() * 0x1p-31 - 1.0; };  // -1 .. 1
    PlanarPose poses[2] = {{-0.2, 0.0, 0.0}, {0.2, 0.1, 1.0}};
    for (std::size_t robot : {0U, 1U}) ground.place(robot, poses[robot]);
    for (int i = 0; i < 400; ++i) {
      for (std::size_t robot : {0U, 1U}) {
        BeltStride stride;
        stride.motion = {0.01 * part(), 0.003 * part(), 0.05 * part()};
        poses[robot].move(stride.motion);
        poses[robot].x_m = std::clamp(poses[robot].x_m, -0.6, 0.6);  // over the edge, too
        stride.pose = poses[robot];
        for (BeltShear& shear : stride.shear) shear = slipping(0.01 * part());
        ground.press(robot, stride);
      }
      ground.end_stride();
      const VolumeBalance balance = ground.balance();
      ASSERT_EQ(balance.error(), 0) << name;
    }
  }
}

TEST(BeltGround, AtRestNothingChanges) {
  BeltGround ground(HeightField::ramp(1.0, 0.02, 12.0), soil_preset("gravel"), TrackGeometry{}, 1);
  ground.place(0, {0.05, 0.03, 0.4});
  const auto stand = [&](int strides) {
    for (int i = 0; i < strides; ++i) {
      ground.press(0, {{0.05, 0.03, 0.4}, {}, {}, 0.0});
      ground.end_stride();
    }
  };
  stand(100);
  const HeightField before = ground.surface();
  const double height = ground.plane(0).height_m;
  stand(1200);
  EXPECT_LE(lowered(before, ground.surface()), 2000);  // 0.1 mm of one cell
  EXPECT_NEAR(ground.plane(0).height_m, height, 1e-6);
}

TEST(BeltGround, SlipDigsALayerAsWideAsTheBelts) {
  BeltFit fit;
  fit.digging = 1.3;
  const TrackGeometry tracks;
  SoilParameters soil = digging(0.002);
  soil.compaction = 1.0;  // what is dug is gone, and booked
  BeltGround ground(flat(), soil, tracks, 1, fit);
  ground.place(0, {});
  const std::int64_t before = ground.balance().compacted;
  constexpr double kSlip_m = 0.02;
  BeltStride stride;
  stride.shear = {slipping(kSlip_m), slipping(kSlip_m)};
  ground.press(0, stride);
  ground.end_stride();
  const double edge = ground.surface().spacing_m();
  const double volume =
      static_cast<double>(ground.balance().compacted - before) * kHeightUnit_m * edge * edge;
  const double expected = fit.digging * 2.0 * soil.slip_layer_m * kSlip_m * tracks.width_m;
  EXPECT_NEAR(volume, expected, 0.01 * expected);
}

// Layer times slip times width is 0.26 of a unit of soil for each belt and stride: what does not
// make a unit is kept for the next.
TEST(BeltGround, WhatIsLessThanAUnitIsDugLater) {
  BeltFit fit;
  fit.digging = 1.0;
  const TrackGeometry tracks;
  SoilParameters soil = digging(0.002);
  soil.compaction = 1.0;
  BeltGround ground(flat(), soil, tracks, 1, fit);
  ground.place(0, {});
  const auto stride = [&](double slip_m) {
    const std::int64_t before = ground.balance().compacted;
    BeltStride slips;
    slips.shear = {slipping(slip_m), slipping(slip_m)};
    ground.press(0, slips);
    ground.end_stride();
    return ground.balance().compacted - before;
  };
  // It has sunk as far as it will.
  for (int i = 0; i < 50; ++i) stride(0.0);
  ASSERT_EQ(stride(0.0), 0);
  const double cells = 0.02 * 0.02;
  const double slip_m = 0.26 * kHeightUnit_m * cells / (0.002 * tracks.width_m);
  std::int64_t dug = 0;
  // After n strides 0.52 n units.
  for (const std::int64_t expected : {0, 1, 1, 2, 2, 3, 3, 4, 4, 5}) {
    dug += stride(slip_m);
    EXPECT_EQ(dug, expected);
  }
}

/// Way of the soil's centre of mass times its volume, along x, cells of 2 cm.
double carried(const BeltGround& ground, const HeightField& before) {
  double sum = 0.0;
  for (int iy = 0; iy < before.ny(); ++iy) {
    for (int ix = 0; ix < before.nx(); ++ix) {
      sum += before.node_x(ix) * (ground.surface().node(ix, iy) - before.node(ix, iy)) *
             kHeightUnit_m * 4e-4;
    }
  }
  return sum;
}

TEST(BeltGround, SlipCarriesSoilDownhillAndWithTheBelt) {
  const TrackGeometry tracks;
  const auto dig = [&](double slope_deg, double slip_carry) {
    SoilParameters soil = digging(0.002);
    soil.slip_carry = slip_carry;
    BeltGround ground(HeightField::ramp(1.0, 0.02, slope_deg), soil, tracks, 1);
    ground.place(0, {});
    const HeightField before = ground.surface();
    for (int i = 0; i < 10; ++i) {
      BeltStride stride;
      stride.shear = {slipping(0.002), slipping(0.002)};
      ground.press(0, stride);
      ground.end_stride();
    }
    double area = 0.0;
    for (const auto& belt : ground.support(0).area) {
      for (const double touched : belt) area += touched;
    }
    return carried(ground, before) / (0.002 * 0.02 * area);
  };
  // Of the layer's volume times the slip: tan(slope) / tan(repose) downhill, the drag's share back.
  const double slope = std::tan(10.0 / 57.29578) / std::tan(30.0 / 57.29578);
  EXPECT_NEAR(dig(0.0, 0.0), 0.0, 0.1);
  EXPECT_NEAR(dig(10.0, 0.0), -slope, 0.12);
  EXPECT_NEAR(dig(0.0, 0.6), -0.6, 0.15);
}

}  // namespace
}  // namespace screed
