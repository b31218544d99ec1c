// The slip watch on tracks, inertia and turns made up by hand.
#include "firmware/estimation/slip_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "firmware/estimation/slip_model.h"
#include "nn/slip/slip_model.h"
#include "paths.h"

namespace screed {
namespace {

constexpr uint16_t kTread_mm = 195;
constexpr double kCountsPerG = 4098.0;

/// A robot that drives straight on or turns; what it feels of that is up to the test. Ground that
/// it moves over shakes it.
struct Drive {
  SlipWatch watch{kTread_mm};
  double speed_mm_per_s = 0.0;
  std::mt19937 random{1};

  struct Feeling {
    double share = 1.0;     ///< of the belts' motion that is the robot's
    int16_t effort = 12;    ///< duty a track beyond what drives it unloaded
    double braking = 0.0;   ///< m/s^2 that the belts do not show
    std::int32_t turn = 0;  ///< angle units/s
  };

  /// Both tracks go to `target`, by 600 mm/s^2 at most, the right one `turn` faster, the left one
  /// as much slower.
  void go(double target_mm_per_s, double seconds, const Feeling& feeling, double turn = 0.0) {
    std::normal_distribution<double> noise;
    for (int i = 0; i < std::lround(seconds * 100.0); ++i) {
      const double change = std::clamp(target_mm_per_s - speed_mm_per_s, -6.0, 6.0);
      speed_mm_per_s += change;
      const double accel_g = (feeling.share * change * 0.1 - feeling.braking) / 9.80665;
      const bool moves = (speed_mm_per_s != 0.0 || turn != 0.0) && feeling.share > 0.5;
      const double shaking = 2.0 + (moves ? 25.0 : 0.0);
      const auto shaken = [&](double counts) {
        return static_cast<int16_t>(std::lround(counts + shaking * noise(random)));
      };
      const TrackMotion left = {static_cast<int16_t>((speed_mm_per_s - turn) * 10.0),
                                feeling.effort};
      const TrackMotion right = {static_cast<int16_t>((speed_mm_per_s + turn) * 10.0),
                                 feeling.effort};
      const int16_t gyro[] = {shaken(0.0), shaken(0.0), 0};
      const int16_t accel[] = {shaken(accel_g * kCountsPerG), 0, shaken(kCountsPerG)};
      watch.tick(left, right, gyro, accel, 0, feeling.turn, i % 2 == 0);
    }
  }
};
constexpr Drive::Feeling kStands = {0.0, 0, 0.0, 0};

TEST(SlipWatch, TracksThatStandTellNothing) {
  Drive drive;
  drive.go(0.0, 20.0, kStands);
  EXPECT_FALSE(drive.watch.slips());
  EXPECT_FALSE(drive.watch.stuck());
}

// A battery at half the motors' voltage doubles the feed-forward: the effort is what is missing.
TEST(SlipWatch, GreatEffortsDoNotOverflow) {
  for (const int16_t effort : std::initializer_list<int16_t>{1200, -1200, 16000, -16000}) {
    SlipWatch watch(kTread_mm);
    const TrackMotion track = {1000, effort};
    const int16_t gyro[] = {0, 0, 0};
    const int16_t accel[] = {0, 0, 4098};
    for (int tick = 0; tick < 400; ++tick) {
      watch.tick(track, track, gyro, accel, 0, 0, true);
      if (tick < 8) continue;
      ASSERT_EQ(watch.network_inputs()[7] > 0, effort > 0) << effort << " tick " << tick;
    }
  }
}

TEST(SlipWatch, ARobotThatMeasuresItsStartIsFree) {
  for (const double speed : {80.0, 150.0, 200.0}) {
    Drive drive;
    drive.go(0.0, 5.0, kStands);
    for (int i = 0; i < 40; ++i) {
      drive.go(speed, 0.5, {});
      ASSERT_FALSE(drive.watch.stuck()) << speed << " mm/s, " << i << " / 2 s";
    }
    EXPECT_FALSE(drive.watch.slips()) << speed;
  }
}

TEST(SlipWatch, OneThatStopsWhileItsTracksGoOnIsStuckWithinASecond) {
  for (const double speed : {100.0, 150.0, 200.0}) {
    Drive drive;
    drive.go(0.0, 5.0, kStands);
    drive.go(speed, 5.0, {});
    ASSERT_FALSE(drive.watch.stuck()) << speed;
    // It runs into something: 0.2 s of braking that the tracks do not show.
    drive.go(speed, 0.2, {0.0, 60, speed / 200.0, 0});
    drive.go(speed, 0.8, {0.0, 60, 0.0, 0});
    EXPECT_TRUE(drive.watch.stuck()) << speed;
    // Tracks that stop are not stuck.
    drive.go(0.0, 1.0, kStands);
    EXPECT_FALSE(drive.watch.stuck()) << speed;
  }
}

TEST(SlipWatch, OneThatStartsAnewIsNoLongerStuck) {
  Drive drive;
  drive.go(0.0, 5.0, kStands);
  drive.go(150.0, 3.0, {});
  drive.go(150.0, 0.2, {0.0, 60, 0.75, 0});
  drive.go(150.0, 2.0, {0.0, 60, 0.0, 0});
  ASSERT_TRUE(drive.watch.stuck());
  EXPECT_LT(drive.watch.travel_share(), 64);
  drive.go(0.0, 0.5, kStands);
  EXPECT_FALSE(drive.watch.stuck());
  EXPECT_EQ(drive.watch.travel_share(), 255);
  drive.go(150.0, 3.0, {});
  EXPECT_FALSE(drive.watch.stuck()) << "it has forgotten";
  EXPECT_GT(drive.watch.travel_share(), 192);
}

// Whatever it feels, the evidence decides: stuck from one threshold, free below another, and
// between them what it was.
TEST(SlipWatch, SlipsIsStuckAndIsFreeFromTheModelsThresholds) {
  using nn::model_slip::kFreeEvidence;
  using nn::model_slip::kSlipEvidence;
  using nn::model_slip::kStuckEvidence;
  static_assert(kFreeEvidence < kSlipEvidence && kSlipEvidence <= kStuckEvidence);
  Drive drive;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform;
  drive.go(0.0, 5.0, kStands);
  int rising = 0;
  int falling = 0;
  int held = 0;
  for (int piece = 0; piece < 400; ++piece) {
    const Drive::Feeling feeling = {uniform(random) < 0.5 ? 1.0 : 0.0,
                                    static_cast<std::int16_t>(uniform(random) * 80.0),
                                    (uniform(random) - 0.5) * 1.5, 0};
    const double speed = 80.0 + 120.0 * uniform(random);
    for (int i = 0; i < 25; ++i) {
      const bool was_stuck = drive.watch.stuck();
      drive.go(speed, 0.04, feeling);
      const std::uint16_t evidence = drive.watch.evidence();
      ASSERT_EQ(drive.watch.slips(), evidence >= kSlipEvidence) << evidence;
      if (evidence >= kStuckEvidence) {
        ASSERT_TRUE(drive.watch.stuck()) << evidence;
        rising += was_stuck ? 0 : 1;
      } else if (evidence < kFreeEvidence) {
        ASSERT_FALSE(drive.watch.stuck()) << evidence;
        falling += was_stuck ? 1 : 0;
      } else {
        ASSERT_EQ(drive.watch.stuck(), was_stuck) << evidence;
        held += was_stuck ? 1 : 0;
      }
    }
  }
  EXPECT_GE(rising, 3);
  EXPECT_GE(falling, 3);
  EXPECT_GE(held, 3);
}

// Half of the speed lost within a few ticks while the tracks go on. What is lost slowly, with the
// tracks, or by hand from outside at rest is no collision.
TEST(SlipWatch, ACollisionIsSpeedLostAtOnce) {
  const auto collides = [](double speed, double seconds, double braking, double target) {
    Drive drive;
    drive.go(0.0, 5.0, kStands);
    drive.go(speed, 3.0, {});
    EXPECT_FALSE(drive.watch.collided()) << speed;
    drive.go(target, seconds, {target == speed ? 0.0 : 1.0, 60, braking, 0});
    return drive.watch.collided();
  };
  EXPECT_TRUE(collides(150.0, 0.05, 3.0, 150.0)) << "all of it in 50 ms";
  EXPECT_TRUE(collides(100.0, 0.05, 2.0, 100.0));
  EXPECT_FALSE(collides(150.0, 1.0, 0.15, 150.0)) << "dug in within a second";
  EXPECT_FALSE(collides(150.0, 0.05, 0.6, 150.0)) << "a fifth of it";
  EXPECT_FALSE(collides(150.0, 0.3, 0.0, 0.0)) << "brakes by its tracks";

  Drive drive;
  drive.go(0.0, 5.0, kStands);
  drive.go(0.0, 0.05, {0.0, 0, 3.0, 0});
  EXPECT_FALSE(drive.watch.collided()) << "kicked at rest";
  drive.go(150.0, 3.0, {});
  drive.go(150.0, 0.05, {0.0, 60, 3.0, 0});
  ASSERT_TRUE(drive.watch.collided());
  drive.go(150.0, 2.4, {0.0, 60, 0.0, 0});
  EXPECT_TRUE(drive.watch.collided()) << "remembered for 2.5 s";
  drive.go(150.0, 0.2, {0.0, 60, 0.0, 0});
  EXPECT_FALSE(drive.watch.collided());
}

TEST(SlipWatch, ATurnThatTheGyroDoesNotSeeIsNone) {
  // 150 mm/s at the tracks turn a robot by 45 degrees/s on firm ground: half is slip.
  constexpr int32_t kTurns = 8192;
  Drive turning;
  turning.go(0.0, 5.0, kStands);
  turning.go(0.0, 3.0, {1.0, 20, 0.0, kTurns}, 150.0);
  EXPECT_FALSE(turning.watch.stuck());
  Drive dug_in;
  dug_in.go(0.0, 5.0, kStands);
  dug_in.go(0.0, 1.0, {0.0, 20, 0.0, 0}, 150.0);
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
    const int16_t gyro[] = {any(), i % 7 == 0 ? extreme : any(), any()};
    const int16_t accel[] = {i % 11 == 0 ? extreme : any(), any(), i % 13 == 0 ? extreme : any()};
    watch.tick(left, right, gyro, accel, static_cast<int16_t>(any() / 2),
               static_cast<int32_t>(any()) * 16, i % 11 != 0);
    ASSERT_TRUE(!watch.stuck() || watch.slips() || watch.evidence() > 0) << i;
  }
}

TEST(SlipWatch, TheRobotsNetworkIsTheModelFiles) {
  const std::filesystem::path models = kModelsFolder;
  const std::string header = nn::slip_model_header(nn::read_slip_model(models / "slip.json"));
  std::ifstream file(models / "../../firmware/estimation/slip_model.h");
  ASSERT_TRUE(file) << "firmware/estimation/slip_model.h";
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), header) << "screed nn slip export";
}

TEST(SlipWatch, EvidenceIsAMeanOverFourSteps) {
  EXPECT_EQ(slip_evidence(0, INT16_MIN), 0);
  EXPECT_NEAR(slip_evidence(0, INT16_MAX), 16384, 2);
  EXPECT_NEAR(slip_evidence(65535, INT16_MIN), 49151, 2);
  EXPECT_NEAR(slip_evidence(20000, 0), 23192, 2);
  std::uint16_t evidence = 0;
  for (int i = 0; i < 60; ++i) evidence = slip_evidence(evidence, INT16_MAX);
  EXPECT_GT(evidence, 65500);
}

}  // namespace
}  // namespace screed
