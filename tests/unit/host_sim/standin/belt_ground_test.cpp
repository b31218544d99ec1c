// The stand-in's ground: Bekker's depth, digging, and a volume that stays.
#include "host_sim/standin/belt_ground.h"

#include <gtest/gtest.h>

#include <cmath>

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

SoilParameters digging(double drag_depth_m) {
  SoilParameters soil = soil_preset("viper");
  soil.drag_depth_m = drag_depth_m;
  return soil;
}

BeltShear slipping(double forward_m) {
  BeltShear shear;
  shear.forward_m = forward_m;
  shear.length_m = std::abs(forward_m);
  shear.patch_m.fill(shear.length_m);
  return shear;
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

TEST(BeltGround, KeepsTheVolumeToTheLastUnitWhateverRobotsDo) {
  for (const char* name : {"gravel", "soft", "clay"}) {
    SoilParameters soil = soil_preset(name);
    soil.drag_depth_m = 0.002;
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
  const double expected = fit.digging * 2.0 * soil.drag_depth_m * kSlip_m * tracks.width_m;
  EXPECT_NEAR(volume, expected, 0.01 * expected);
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
  const auto dig = [&](double slope_deg, double drag_share, double downhill) {
    BeltFit fit;
    fit.downhill = downhill;
    SoilParameters soil = digging(0.002);
    soil.drag_share = drag_share;
    BeltGround ground(HeightField::ramp(1.0, 0.02, slope_deg), soil, tracks, 1, fit);
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
  EXPECT_NEAR(dig(0.0, 0.0, 1.0), 0.0, 0.1);
  EXPECT_NEAR(dig(10.0, 0.0, 1.0), -slope, 0.12);
  EXPECT_NEAR(dig(0.0, 0.6, 1.0), -0.6, 0.15);
  // The fitted number is of what gravity carries alone; what is pressed comes up downhill, too.
  const double pressed = dig(10.0, 0.0, 0.0);
  EXPECT_NEAR((dig(10.0, 0.0, 0.4) - pressed) / (dig(10.0, 0.0, 1.0) - pressed), 0.4, 0.02);
  EXPECT_EQ(dig(0.0, 0.6, 0.4), dig(0.0, 0.6, 1.0));
}

}  // namespace
}  // namespace screed
