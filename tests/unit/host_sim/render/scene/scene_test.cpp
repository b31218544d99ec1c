// Scenes for POV-Ray: what stands where, and what the camera sees.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/render/scene/povray.h"
#include "host_sim/render/scene/robot_scene.h"
#include "host_sim/render/scene/scene_camera.h"
#include "host_sim/render/scene/sphere_scene.h"
#include "host_sim/render/scene/terrain_scene.h"
#include "paths.h"

namespace screed {
namespace {

/// 5 x 4 heights of 10 cm spacing rising to the east by 1 cm a node, and north by 2 cm.
HeightMap slope(bool wrap) {
  HeightMap map;
  map.geometry = {5, 4, 0.001, 0.1, -0.2, -0.15, wrap};
  for (int iy = 0; iy < 4; ++iy) {
    for (int ix = 0; ix < 5; ++ix) map.heights.push_back(10 * ix + 20 * iy);
  }
  return map;
}

double flat(double, double) {
  return 0.0;
}

uint16_t at(const GreyRaster& raster, size_t column, size_t row) {
  return raster.samples.at(row * static_cast<size_t>(raster.width) + column);
}

size_t count(const std::string& text, const std::string& part) {
  size_t found = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(Walls, AreABoardAsHighAsTheGroundOnEachSide) {
  HeightMap map = slope(false);
  EXPECT_EQ(walls_text(TerrainSurface(map)), "");
  map.geometry.walls = true;
  const std::string text = walls_text(TerrainSurface(map));
  EXPECT_EQ(count(text, "box {"), 4U);
  // West of the bed, up to 3 cm above its highest place there; the ground rises by 6 cm along it.
  EXPECT_EQ(count(text, "<-0.21800,-0.15000,-0.06000>, <-0.20000,0.15000,0.09000>"), 1U) << text;
  EXPECT_EQ(count(text, "<0.20000,-0.15000,-0.06000>, <0.21800,0.15000,0.13000>"), 1U) << text;
}

TEST(TerrainSurface, IsBilinearAndEndsLevel) {
  const HeightMap map = slope(false);
  const TerrainSurface ground(map);
  EXPECT_NEAR(ground.height_m(-0.2, -0.15), 0.0, 1e-12);
  EXPECT_NEAR(ground.height_m(0.2, 0.15), 0.1, 1e-12);
  EXPECT_NEAR(ground.height_m(-0.15, -0.1), 0.015, 1e-12);
  EXPECT_NEAR(ground.height_m(9.0, 9.0), 0.1, 1e-12);
  EXPECT_NEAR(ground.width_m(), 0.4, 1e-12);
  EXPECT_NEAR(ground.depth_m(), 0.3, 1e-12);
  EXPECT_NEAR(ground.lowest_m(), 0.0, 1e-12);
  EXPECT_NEAR(ground.highest_m(), 0.1, 1e-12);
}

TEST(TerrainSurface, RepeatsWithWrapAround) {
  const HeightMap map = slope(true);
  const TerrainSurface ground(map);
  EXPECT_NEAR(ground.width_m(), 0.5, 1e-12);
  for (const double beds : {-7.0, -1.0, 1.0, 12.0}) {
    EXPECT_NEAR(ground.height_m(-0.13 + beds * 0.5, -0.02 - beds * 0.4),
                ground.height_m(-0.13, -0.02), 1e-12);
  }
  EXPECT_NEAR(ground.height_m(0.25, -0.15), 0.02, 1e-12);  // halfway back from 40 mm to 0
}

TEST(TerrainSurface, RefusesWhatIsNoSurface) {
  HeightMap map = slope(false);
  map.geometry.nx = 1;
  EXPECT_THROW(TerrainSurface{map}, InputError);
}

TEST(HeightRaster, NorthIsOnTopAndTheRangeIsUsed) {
  const HeightMap map = slope(false);
  const GreyRaster raster = height_raster(TerrainSurface(map));
  ASSERT_EQ(raster.width, 5);
  ASSERT_EQ(raster.height, 4);
  EXPECT_EQ(raster.samples[4], 65535);  // north-east
  EXPECT_EQ(at(raster, 0, 3), 0);       // south-west
  EXPECT_EQ(raster.samples[0], 39321);  // north-west: 60 of 100 mm
  EXPECT_EQ(at(raster, 4, 3), 26214);   // south-east: 40 of 100 mm
}

TEST(HeightRaster, EndsWhereTheBedBeginsAgain) {
  const HeightMap map = slope(true);
  const GreyRaster raster = height_raster(TerrainSurface(map));
  ASSERT_EQ(raster.width, 6);
  ASSERT_EQ(raster.height, 5);
  for (size_t column = 0; column < 6; ++column) {
    EXPECT_EQ(raster.samples[column], at(raster, column, 4));
  }
  for (size_t row = 0; row < 5; ++row) {
    EXPECT_EQ(at(raster, 0, row), at(raster, 5, row));
  }
}

TEST(ChangeRaster, ShowsWhereGroundWasMovedOnly) {
  const HeightMap before = slope(false);
  EXPECT_TRUE(change_raster(TerrainSurface(before), before).samples.empty());
  HeightMap after = before;
  after.heights[7] -= 3;  // ix 2, iy 1: 3 mm of the 6 that are full white
  after.heights[19] += 50;
  const GreyRaster raster = change_raster(TerrainSurface(after), before);
  ASSERT_EQ(raster.samples.size(), 20u);
  EXPECT_EQ(at(raster, 2, 2), 32768);
  EXPECT_EQ(raster.samples[4], 65535);
  EXPECT_EQ(raster.samples[0], 0);
}

TEST(Ground, IsDrawnOnceOrAllAround) {
  const HeightMap single = slope(false);
  const HeightMap repeated = slope(true);
  const std::string once =
      terrain_text(TerrainSurface(single), {"h.png", ""}, soil_appearance("clay"));
  EXPECT_EQ(count(once, "object { Bed"), 1u);
  EXPECT_EQ(count(once, "mesh2"), 4u);  // the cuts
  EXPECT_NE(once.find("\"h.png\""), std::string::npos);
  const std::string many =
      terrain_text(TerrainSurface(repeated), {"h.png", "c.png"}, soil_appearance(""));
  EXPECT_EQ(count(many, "object { Bed"), 49u);
  EXPECT_EQ(count(many, "mesh2"), 0u);
  EXPECT_NE(many.find("\"c.png\""), std::string::npos);
}

TEST(Path, BreaksWhereTheRobotWasPutElsewhere) {
  const HeightMap map = slope(false);
  const TerrainSurface ground(map);
  const std::vector<Eigen::Vector2d> path = {{0, 0}, {0.05, 0}, {0.1, 0}, {-0.2, 0}, {-0.15, 0}};
  EXPECT_EQ(count(path_text(path, ground, 0.002), "cylinder"), 3u);
  EXPECT_EQ(path_text({}, ground, 0.002), "");
}

TEST(Camera, StandsWhereItIsTold) {
  const Eigen::Vector3d target(1.0, 2.0, 0.5);
  // From ahead of a robot that faces north: to its north.
  const SceneCamera ahead = camera_at(camera_orbit("0,0,2"), target, std::numbers::pi / 2.0, flat);
  EXPECT_NEAR((ahead.location - Eigen::Vector3d(1.0, 4.0, 0.5)).norm(), 0.0, 1e-9);
  const SceneCamera left = camera_at(camera_orbit("90,30,1"), target, 0.0, flat);
  EXPECT_NEAR(left.location.y(), 2.0 + std::cos(std::numbers::pi / 6.0), 1e-9);
  EXPECT_NEAR(left.location.z(), 1.0, 1e-9);
}

TEST(Camera, LooksOverAHill) {
  const auto hill = [](double x, double) { return x > 0.2 && x < 0.4 ? 0.4 : 0.0; };
  const Eigen::Vector3d target(0.0, 0.0, 0.05);
  const SceneCamera camera = camera_at(camera_orbit("0,10,0.8"), target, 0.0, hill);
  const double slope = (camera.location.z() - target.z()) / camera.location.x();
  EXPECT_GT(target.z() + slope * 0.21, 0.4);
  EXPECT_NEAR((camera.location - target).norm(), 0.8, 1e-9);
}

TEST(Camera, RefusesOtherPlaces) {
  for (const char* text : {"", "behind", "1,2", "1,2,3,4", "0,-5,1", "0,90,1", "0,10,0.1",
                           "0,10,nan", "nan,10,1", "0,10,1m"}) {
    EXPECT_THROW(camera_orbit(text), InputError) << text;
  }
  for (const char* name : {"front", "back", "side", "above", "bed"}) {
    EXPECT_NO_THROW(camera_orbit(name)) << name;
  }
}

/// The corners of a bed round (0, 0) from its floor to its highest place.
std::vector<Eigen::Vector3d> box(double width, double depth, double low, double high) {
  std::vector<Eigen::Vector3d> points;
  for (const double x : {-width / 2.0, width / 2.0}) {
    for (const double y : {-depth / 2.0, depth / 2.0}) {
      points.emplace_back(x, y, low);
      points.emplace_back(x, y, high);
    }
  }
  return points;
}

TEST(BedCamera, SeesAllOfAnyBedInAnyPictureAndFillsIt) {
  constexpr double kMargin = 0.03;
  struct Bed {
    double width;
    double depth;
    double height;
  };
  for (const Bed& bed :
       {Bed{1.5, 1.28, 0.1}, Bed{3.0, 2.56, 0.3}, Bed{6.0, 6.0, 0.5}, Bed{0.5, 12.0, 0.2},
        Bed{20.0, 0.6, 0.2}, Bed{1.0, 1.0, 3.0}, Bed{100.0, 100.0, 20.0}, Bed{0.1, 0.1, 0.001}}) {
    for (const double aspect : {1.6, 1.0, 0.5, 16.0 / 9.0, 4.0}) {
      const PictureFormat format{40.0, aspect};
      std::vector<Eigen::Vector3d> points = box(bed.width, bed.depth, -0.06, bed.height);
      points.emplace_back(0.3 * bed.width, -0.2 * bed.depth, 1.2 * bed.height);  // the highest
      const SceneCamera camera = camera_around(camera_orbit("bed"), points, format, kMargin);
      double outermost = 0.0;
      for (const Eigen::Vector3d& point : points) {
        const Eigen::Vector3d seen = project(camera, format, point);
        EXPECT_GT(seen.z(), 0.0);
        EXPECT_LE(std::abs(seen.x()), 1.0 - kMargin + 1e-9) << bed.width << " " << aspect;
        EXPECT_LE(std::abs(seen.y()), 1.0 - kMargin + 1e-9) << bed.depth << " " << aspect;
        outermost = std::max({outermost, std::abs(seen.x()), std::abs(seen.y())});
      }
      EXPECT_NEAR(outermost, 1.0 - kMargin, 1e-6) << "the camera is no further away than needed";
    }
  }
}

TEST(BedCamera, PointsAppearWhereTheCameraSeesThem) {
  // From the south, level: east is right, up is up.
  const SceneCamera camera{{0.0, -2.0, 0.0}, {0.0, 0.0, 0.0}};
  const PictureFormat format{90.0, 2.0};  // half as wide as deep, half of that high
  EXPECT_NEAR((project(camera, format, {0.0, 5.0, 0.0}) - Eigen::Vector3d(0, 0, 7)).norm(), 0.0,
              1e-12);
  EXPECT_NEAR(project(camera, format, {1.0, 0.0, 0.0}).x(), 0.5, 1e-12);
  EXPECT_NEAR(project(camera, format, {0.0, 0.0, 0.5}).y(), 0.5, 1e-12);
  EXPECT_NEAR(project(camera, format, {0.0, -1.0, 0.0}).z(), 1.0, 1e-12);
}

TEST(HeightTintScale, EndsAtRoundMillimetresRoundTheHeights) {
  const HeightTint tint = height_tint(-0.0132, 0.1471);
  EXPECT_LE(tint.low_m, -0.0132);
  EXPECT_GE(tint.high_m, 0.1471);
  EXPECT_NEAR(tint.low_m * 1000.0, -50.0, 1e-9);
  EXPECT_NEAR(tint.high_m * 1000.0, 150.0, 1e-9);
  const HeightTint level = height_tint(0.25, 0.25);
  EXPECT_LT(level.low_m, level.high_m);
}

TEST(HeightTintScale, IsMixedIntoTheTerrainWhereAskedFor) {
  const HeightMap map = slope(false);
  const HeightTint tint = height_tint(0.0, 0.1);
  const std::string plain =
      terrain_text(TerrainSurface(map), {"h.png", ""}, soil_appearance("clay"));
  const std::string colored =
      terrain_text(TerrainSurface(map), {"h.png", ""}, soil_appearance("clay"), tint);
  EXPECT_EQ(count(plain, "HeightColors"), 0u);
  EXPECT_EQ(count(colored, "HeightColors"), 1u);
  EXPECT_EQ(count(tint_text(tint), "#declare HeightColors"), 1u);
  const SceneCamera camera{{0.0, -2.0, 1.0}, {0.0, 0.0, 0.0}};
  const std::string legend = tint_legend_text(tint, camera, {40.0, 1.6});
  for (const char* words : {"\"height [mm]\"", "\"0\"", "\"100\""}) {
    EXPECT_EQ(count(legend, words), 1u) << words;
  }
}

TEST(Spheres, AreRoundAndThoseThatCanBeSeen) {
  SphereSet bed;
  bed.radius_m = 0.01;
  // 9 x 9 columns of 10 stones: those of the edge are seen from the side, of the others the top.
  for (int x = 0; x < 9; ++x) {
    for (int y = 0; y < 9; ++y) {
      for (int z = 0; z < 10; ++z) {
        bed.centers_m.push_back({0.0205F * static_cast<float>(x), 0.0205F * static_cast<float>(y),
                                 0.01F + 0.02F * static_cast<float>(z)});
      }
    }
  }
  const std::vector<size_t> visible = visible_spheres(bed);
  size_t edge = 0;
  for (const size_t i : visible) {
    const size_t x = i / 90;
    const size_t y = i / 10 % 9;
    const bool is_edge = x == 0 || y == 0 || x == 8 || y == 8;
    if (is_edge) {
      ++edge;
    } else {
      EXPECT_GT(i % 10, 6u) << "a stone deep inside";
    }
  }
  EXPECT_EQ(edge, 32u * 10u);
  EXPECT_EQ(visible.size(), 32u * 10u + 49u * 3u);
  const std::string text = spheres_text(bed, soil_appearance("gravel"), std::nullopt);
  EXPECT_EQ(count(text, "sphere { <"), visible.size());
  EXPECT_EQ(count(text, ">, 0.010000 texture"), visible.size());
  EXPECT_TRUE(visible_spheres({}).empty());
}

class RobotScene : public ::testing::Test {
 protected:
  Assembly robot_ =
      import_urdf(std::filesystem::path(kBoardsFolder) / "a_star_32u4" / "rover5.urdf");
};

TEST_F(RobotScene, HasEveryBodyAndItsRunningGear) {
  const std::string tracks = robot_text(robot_, true, {});
  const std::string wheels = robot_text(robot_, false, {});
  EXPECT_EQ(count(tracks, "object { Wheel("), 4u);
  EXPECT_EQ(count(wheels, "object { Wheel("), 4u);
  EXPECT_EQ(count(tracks, "difference { Stadium("), 2u);  // two belts
  EXPECT_EQ(count(wheels, "difference { Stadium("), 4u);  // four tyres
  EXPECT_EQ(count(tracks, "texture { Paint }"), 1u);
}

TEST_F(RobotScene, TurnsItsWheelsAsFarAsTheyHaveRolled) {
  RobotPose pose;
  pose.travel_m = {0.0, 0.03 * std::numbers::pi / 2.0};  // a quarter of a turn of 30 mm wheels
  const std::string text = robot_text(robot_, false, pose);
  EXPECT_EQ(count(text, "rotate y*90.000 translate x*"), 2u);
  EXPECT_EQ(count(text, "rotate y*0.000 translate x*"), 2u);
}

TEST(Povray, WritesPngAndJpgOnly) {
  EXPECT_NO_THROW(check_picture_name("a.png"));
  EXPECT_NO_THROW(check_picture_name("a.b/c.jpg"));
  for (const char* name : {"a", "a.bmp", "png", ".png", "a.PNG"}) {
    EXPECT_THROW(check_picture_name(name), InputError) << name;
  }
}

}  // namespace
}  // namespace screed
