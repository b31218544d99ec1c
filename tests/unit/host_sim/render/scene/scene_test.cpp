// Scenes for POV-Ray: what stands where, and what the camera sees.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/render/scene/povray.h"
#include "host_sim/render/scene/robot_scene.h"
#include "host_sim/render/scene/scene_camera.h"
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
