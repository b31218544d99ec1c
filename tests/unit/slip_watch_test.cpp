// The slip watch on tracks, inertia and turns made up by hand.
#include "firmware/estimation/slip_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "nn/model/header_export.h"
#include "nn/model/model_file.h"
#include "paths.h"

namespace screed {
namespace {

constexpr uint16_t kTread_mm = 195;
constexpr double kCountsPerG = 4098.0;

/// A robot that drives straight on or turns; what it feels of that is up to the test.
struct Drive {
  SlipWatch watch{kTread_mm};
  double speed_mm_per_s = 0.0;

  /// Both tracks go to `target`, by 600 mm/s^2 at most; the accelerometer feels so much of it.
  void go(double target_mm_per_s, double seconds, double felt, int16_t effort, double turn = 0.0,
          int32_t yaw_rate = 0) {
    for (int i = 0; i < std::lround(seconds * 100.0); ++i) {
      const double change = std::clamp(target_mm_per_s - speed_mm_per_s, -6.0, 6.0);
      speed_mm_per_s += change;
      const double accel_g = felt * change * 0.1 / 9.80665;
      const TrackMotion left = {static_cast<int16_t>((speed_mm_per_s - turn) * 10.0), effort};
      const TrackMotion right = {static_cast<int16_t>((speed_mm_per_s + turn) * 10.0), effort};
      watch.tick(left, right, static_cast<int16_t>(std::lround(accel_g * kCountsPerG)), 0, yaw_rate,
                 i % 2 == 0);
    }
  }
};

TEST(SlipWatch, TracksThatStandTellNothing) {
  Drive drive;
  drive.go(0.0, 20.0, 1.0, 0);
  EXPECT_FALSE(drive.watch.slips());
  EXPECT_FALSE(drive.watch.stuck());
}

TEST(SlipWatch, ARobotThatFeelsItsStartIsFree) {
  for (const double speed : {80.0, 150.0, 200.0}) {
    Drive drive;
    drive.go(0.0, 5.0, 1.0, 0);
    drive.go(speed, 20.0, 1.0, 5);
    EXPECT_FALSE(drive.watch.stuck()) << speed;
    EXPECT_FALSE(drive.watch.slips()) << speed;
  }
}

TEST(SlipWatch, OneThatStopsWhileItsTracksGoOnIsStuckWithinASecond) {
  for (const double speed : {100.0, 150.0, 200.0}) {
    Drive drive;
    drive.go(0.0, 5.0, 1.0, 0);
    drive.go(speed, 5.0, 1.0, 5);
    ASSERT_FALSE(drive.watch.stuck()) << speed;
    // It runs into something: 0.2 s of braking that the tracks do not show.
    const TrackMotion track = {static_cast<int16_t>(speed * 10.0), 60};
    const auto braking = static_cast<int16_t>(-speed / 200.0 / 9.80665 * kCountsPerG);
    for (int i = 0; i < 100; ++i)
      drive.watch.tick(track, track, i < 20 ? braking : 0, 0, 0, i % 2 == 0);
    EXPECT_TRUE(drive.watch.stuck()) << speed;
    // Tracks that stop are not stuck.
    drive.speed_mm_per_s = speed;
    drive.go(0.0, 1.0, 0.0, 0);
    EXPECT_FALSE(drive.watch.stuck()) << speed;
  }
}

TEST(SlipWatch, ATurnThatTheGyroDoesNotSeeIsNone) {
  // 150 mm/s at the tracks turn a robot by 45 degrees/s on firm ground: half is slip.
  constexpr int32_t kTurns = 8192;
  Drive turning;
  turning.go(0.0, 5.0, 1.0, 0);
  turning.go(0.0, 3.0, 1.0, 10, 150.0, kTurns);
  EXPECT_FALSE(turning.watch.stuck());
  Drive dug_in;
  dug_in.go(0.0, 5.0, 1.0, 0);
  dug_in.go(0.0, 1.0, 1.0, 10, 150.0, 0);
  EXPECT_TRUE(dug_in.watch.stuck());
}

TEST(SlipWatch, BearsAnything) {
  std::mt19937 random(1);
  const auto any = [&] { return static_cast<int16_t>(random()); };
  SlipWatch watch(kTread_mm);
  for (int i = 0; i < 20000; ++i) {
    const int16_t extreme = i % 3 == 0 ? INT16_MIN : INT16_MAX;
    const TrackMotion left = {i % 5 == 0 ? extreme : any(), static_cast<int16_t>(any() % 801)};
    const TrackMotion right = {any(), static_cast<int16_t>(any() % 801)};
    watch.tick(left, right, i % 7 == 0 ? extreme : any(), static_cast<int16_t>(any() / 2),
               static_cast<int32_t>(any()) * 16, i % 11 != 0);
    ASSERT_GE(watch.evidence(), 0);
  }
}

TEST(SlipWatch, TheRobotsNetworkIsTheModelFiles) {
  const std::filesystem::path models = kModelsFolder;
  const std::string header = nn::model_header(nn::read_model(models / "slip.json"));
  std::ifstream file(models / "../../firmware/estimation/slip_model.h");
  ASSERT_TRUE(file) << "firmware/estimation/slip_model.h";
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), header) << "screed nn export nn/models/slip.json --header "
                                   "firmware/estimation/slip_model.h";
}

}  // namespace
}  // namespace screed
