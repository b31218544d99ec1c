// How far two recordings of the same drive are apart, on made-up ones.
#include "nn/surrogate/rollout.h"

#include <gtest/gtest.h>

#include "tests/unit/nn/surrogate/made_up_drive.h"

namespace screed::nn {
namespace {

struct Pair {
  TempFolder folder;
  Rollout divergence(const MadeUpDrive& one, const MadeUpDrive& other) const {
    record(folder.path() / "one", one);
    record(folder.path() / "other", other);
    Rollout result = nn::divergence(folder.path() / "one", folder.path() / "other");
    fs::remove_all(folder.path() / "one");
    fs::remove_all(folder.path() / "other");
    return result;
  }
};

TEST(Apart, TheSameDriveFromAnotherPlaceIsNotApart) {
  MadeUpDrive other;
  other.x = 0.7;
  other.y = -0.2;
  other.before = 9;
  const Rollout result = Pair().divergence({}, other);
  EXPECT_EQ(result.start, 5U);
  for (std::size_t i = 0; i < 2; ++i) {  // 6 m: the last of the ways is not made
    ASSERT_TRUE(result.checks[i].reached) << i;
    EXPECT_TRUE(result.checks[i].straight);
    EXPECT_NEAR(result.checks[i].position_error, 0.0, 1e-9);
    EXPECT_NEAR(result.checks[i].heading_error_rad, 0.0, 1e-9);
  }
  EXPECT_FALSE(result.checks[2].reached);
}

TEST(Apart, ThePlaceErrorIsTheDistanceAsShareOfTheWay) {
  MadeUpDrive other;
  other.distance_m = 0.0051;  // two per cent longer
  const Rollout result = Pair().divergence({}, other);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(result.checks[i].position_error, 0.02, 5e-4) << i;
    EXPECT_NEAR(result.checks[i].heading_error_rad, 0.0, 1e-9);
  }
}

TEST(Apart, TheHeadingErrorGrowsWithTheTurn) {
  MadeUpDrive other;
  other.turn_rad = -1e-4;
  const Rollout result = Pair().divergence({}, other);
  EXPECT_NEAR(result.checks[0].heading_error_rad, 0.02, 3e-4) << "after 200 frames";
  EXPECT_NEAR(result.checks[1].heading_error_rad, 0.1, 3e-4) << "after 1000";
  // A circle of 50 m radius leaves its tangent by way^2 / (2 radius).
  EXPECT_NEAR(result.checks[0].position_error, 0.01, 3e-4);
  EXPECT_NEAR(result.checks[1].position_error, 0.05, 3e-4);
}

TEST(Apart, AWantedTurnMakesAWayThatIsNotStraight) {
  MadeUpDrive one;
  one.angular = 0.5;
  EXPECT_FALSE(Pair().divergence(one, {}).checks[0].straight);
}

TEST(Apart, ThePathHasTenPlacesASecondFromTheFirstOne) {
  const Rollout result = Pair().divergence({}, {});
  ASSERT_GT(result.path.size(), 10U);
  // The comparison begins one frame behind the start.
  EXPECT_NEAR(result.path[1].x_m - result.path[0].x_m, 0.05, 1e-9);
  EXPECT_NEAR(result.path.back().x_m, 5.95, 0.06);
}

TEST(Apart, AnEvenTurnHasNoWagsAndAnUnevenOneHas) {
  MadeUpDrive even;
  even.turn_rad = 2e-4;
  const Rollout result = Pair().divergence(even, even);
  EXPECT_NEAR(result.recorded_yaw_rate_deviation_rad_per_s, 0.0, 1e-3);
  EXPECT_NEAR(result.yaw_rate_deviation_rad_per_s, result.recorded_yaw_rate_deviation_rad_per_s,
              1e-3);
}

TEST(Apart, TheHeadingAtTheBeginningIsNoError) {
  MadeUpDrive other;
  other.heading_rad = 0.3;
  const Rollout result = Pair().divergence({}, other);
  EXPECT_NEAR(result.checks[0].heading_error_rad, 0.0, 1e-9);
  // Paths are compared as they lie.
  EXPECT_NEAR(result.checks[0].position_error, 2.0 * std::sin(0.15), 2e-3);
}

TEST(Apart, TheComparisonEndsWithTheShorterRecording) {
  MadeUpDrive other;
  other.before = 9;
  for (const bool first_is_shorter : {false, true}) {
    MadeUpDrive one;
    MadeUpDrive& shorter = first_is_shorter ? one : other;
    shorter.frames = 101;
    EXPECT_EQ(Pair().divergence(one, other).path.size(), 10U);
    shorter.frames = 100;
    EXPECT_EQ(Pair().divergence(one, other).path.size(), 9U);
    shorter.frames = 1200;
  }
}

TEST(Apart, TheComparisonBeginsBehindTheFirstFrame) {
  MadeUpDrive one;
  one.frames = 101;
  const auto deviation_with_turn_in = [&](std::size_t turning) {
    one.alter = [=](std::size_t row, SimFrame& frame, SensorSample&) {
      if (row == turning) frame.delta_theta = 0.2;
    };
    return Pair().divergence(one, one).recorded_yaw_rate_deviation_rad_per_s;
  };
  EXPECT_EQ(deviation_with_turn_in(4), 0.0);
  EXPECT_EQ(deviation_with_turn_in(5), 0.0);
  // One of a hundred frames turns, with 20 rad/s.
  EXPECT_NEAR(deviation_with_turn_in(6), 20.0 * std::sqrt(0.01 - 0.0001), 1e-9);
}

TEST(Apart, ARecordingWithoutSoilOrWithoutADriveIsRefused) {
  const TempFolder folder;
  MadeUpDrive still;
  still.frames = 2;
  record(folder.path() / "still", still);
  EXPECT_NE(message_of<InputError>([&] {
              divergence(folder.path() / "still", folder.path() / "still");
            }).find("drove no frame"),
            std::string::npos);
  record(folder.path() / "rigid", {});
  write_text(folder.path() / "rigid" / "experiment.ini", "[map]\nmodel = rigid\n");
  EXPECT_NE(message_of<InputError>([&] {
              divergence(folder.path() / "rigid", folder.path() / "rigid");
            }).find("session on soil"),
            std::string::npos);
}

}  // namespace
}  // namespace screed::nn
