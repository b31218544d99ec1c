// How far two recordings of the same drive are apart, on made-up ones.
#include "nn/surrogate/rollout.h"

#include <gtest/gtest.h>

#include "nn/data/features.h"
#include "tests/unit/nn/surrogate/linear_model.h"
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

// ---- Rollouts whose tracks turn as recorded, on made-up drives: what diverges how far is known in
// closed form

SurrogateFactory skidding(double speed_share = 1.0) {
  return {"skid",
          [=] { return Surrogate(skid_kinematics(speed_share, kTread_m), SupportGeometry{}, 1); }};
}

SurrogateFactory network(const Model& model) {
  return {"network", [=] { return Surrogate(model, SupportGeometry{}, 1); }};
}

SessionRollouts rollouts(const MadeUpDrive& drive, const std::vector<SurrogateFactory>& surrogates,
                         std::size_t starts = 0, std::uint64_t max_frames = 40000) {
  const TempFolder folder;
  record(folder.path() / "run", drive);
  RolloutOptions options;
  options.drive = RolloutDrive::kTracks;
  options.starts = starts;
  options.max_frames = max_frames;
  return roll_out(folder.path() / "run", surrogates, options);
}

std::vector<std::uint64_t> starts_of(const SessionRollouts& result) {
  std::vector<std::uint64_t> starts;
  for (const Rollout& rollout : result.by_surrogate.front()) starts.push_back(rollout.start);
  return starts;
}

MadeUpDrive exact(std::size_t frames) {
  MadeUpDrive drive;
  drive.distance_m = kExact_m;
  drive.frames = frames;
  return drive;
}

// Five frames at rest, and two whose motion a surrogate may need.
constexpr std::uint64_t kBegin = 7;

TEST(RolloutTracks, ARobotThatDoesNotSlipFollowsTheRecordingOfOne) {
  MadeUpDrive drive = exact(1400);
  drive.x = 0.3;
  drive.y = -0.4;
  drive.heading_rad = 1.0;
  drive.turn_rad = 0.001;
  const SessionRollouts result = rollouts(drive, {skidding()}, 1);
  EXPECT_EQ(result.source, "made_up");
  ASSERT_EQ(result.by_surrogate.size(), 1U);
  ASSERT_EQ(result.by_surrogate[0].size(), 1U);
  ASSERT_EQ(result.real.size(), 1U);
  const Rollout& rollout = result.by_surrogate[0][0];
  EXPECT_EQ(rollout.start, kBegin);
  for (const RolloutCheck& check : rollout.checks) {
    EXPECT_TRUE(check.reached);
    EXPECT_NEAR(check.position_error, 0.0, 1e-9);
    EXPECT_NEAR(check.heading_error_rad, 0.0, 1e-9);
  }
  // Ten poses a second until 10 m are made, with the 1,280th frame.
  ASSERT_EQ(rollout.path.size(), 128U);
  ASSERT_EQ(result.real[0].size(), 128U);
  for (std::size_t i = 0; i < 128; ++i) {
    EXPECT_NEAR(rollout.path[i].x_m, result.real[0][i].x_m, 1e-9);
    EXPECT_NEAR(rollout.path[i].y_m, result.real[0][i].y_m, 1e-9);
    EXPECT_NEAR(rollout.path[i].heading_rad, result.real[0][i].heading_rad, 1e-9);
  }
  EXPECT_NEAR(result.real[0][0].heading_rad, 1.0 + 13 * 0.001, 1e-9);
}

TEST(RolloutTracks, EverySurrogateHasItsErrorsAtTheSameStarts) {
  const SessionRollouts result = rollouts(exact(1500), {skidding(0.9), skidding(), skidding(1.2)});
  ASSERT_EQ(result.by_surrogate.size(), 3U);
  constexpr std::array<double, 3> kErrors = {0.1, 0.0, 0.2};
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(result.by_surrogate[i].size(), 2U);
    for (const RolloutCheck& check : result.by_surrogate[i][0].checks) {
      EXPECT_TRUE(check.straight);
      EXPECT_NEAR(check.position_error, kErrors.at(i), 1e-9);
      EXPECT_NEAR(check.heading_error_rad, 0.0, 1e-9);
    }
    EXPECT_EQ(result.by_surrogate[i][1].start, kBegin + 1280);
  }
}

TEST(RolloutTracks, ATurnThatTheRobotDidNotMakeIsTheHeadingError) {
  MadeUpDrive drive = exact(1400);
  drive.alter = [](std::size_t, SimFrame& frame, SensorSample&) {
    frame.track_right += 0.01;
    frame.angular = 0.1;
  };
  const SessionRollouts result = rollouts(drive, {skidding()}, 1);
  const double turn = 0.01 / 0.127 * 0.01;  // a frame
  const auto& checks = result.by_surrogate[0][0].checks;
  EXPECT_NEAR(checks[0].heading_error_rad, 128 * turn, 1e-9);
  EXPECT_NEAR(checks[1].heading_error_rad, 640 * turn, 1e-9);
  EXPECT_NEAR(checks[2].heading_error_rad, 1280 * turn, 1e-9);
  for (const RolloutCheck& check : checks) EXPECT_FALSE(check.straight);
}

TEST(RolloutTracks, WithoutANumberOfStartsEachBeginsWhereTheOneBeforeEnded) {
  // 23.4 m are behind the first start: the third rollout makes 3.4 m.
  const SessionRollouts result = rollouts(exact(2 + 2 * 1280 + 436), {skidding()});
  EXPECT_EQ(starts_of(result),
            (std::vector<std::uint64_t>{kBegin, kBegin + 1280, kBegin + 2 * 1280}));
  ASSERT_EQ(result.real.size(), 3U);
  EXPECT_EQ(result.real[1].size(), 128U);
  EXPECT_EQ(result.real[2].size(), 43U);
  const auto& checks = result.by_surrogate[0][2].checks;
  EXPECT_TRUE(checks[0].reached);
  EXPECT_FALSE(checks[1].reached);
  EXPECT_EQ(result.by_surrogate[0][2].path.size(), 43U);
}

TEST(RolloutTracks, ANumberOfStartsIsSpreadEvenlyOverTheDrive) {
  // Rows 7..1606.
  const SessionRollouts result = rollouts(exact(1602), {skidding()}, 4);
  EXPECT_EQ(starts_of(result), (std::vector<std::uint64_t>{7, 407, 807, 1207}));
}

TEST(RolloutTracks, AStartWithoutAMetreLeftGivesNoError) {
  // Starts 7, 107, ... of rows 7..1006; from 907 on there are 99 frames left.
  EXPECT_EQ(starts_of(rollouts(exact(1002), {skidding()}, 10)).back(), 807U);
  const SessionRollouts all = rollouts(exact(2 + 1280 + 129), {skidding()});
  EXPECT_EQ(starts_of(all), (std::vector<std::uint64_t>{kBegin, kBegin + 1280}));
  EXPECT_TRUE(all.by_surrogate[0][1].checks[0].reached);
  const SessionRollouts short_of_it = rollouts(exact(2 + 1280 + 128), {skidding()});
  EXPECT_EQ(starts_of(short_of_it), (std::vector<std::uint64_t>{kBegin}));
  EXPECT_EQ(short_of_it.real.size(), 1U);
}

TEST(RolloutTracks, NoRolloutHasMoreFramesThanItMayHave) {
  const SessionRollouts result = rollouts(exact(622), {skidding()}, 0, 200);
  EXPECT_EQ(starts_of(result), (std::vector<std::uint64_t>{7, 207, 407}));
  for (const Rollout& rollout : result.by_surrogate[0]) {
    EXPECT_TRUE(rollout.checks[0].reached);
    EXPECT_FALSE(rollout.checks[1].reached);
    EXPECT_EQ(rollout.path.size(), 20U);
  }
  EXPECT_EQ(result.real[0].size(), 20U);
  const SessionRollouts shorter = rollouts(exact(622), {skidding()}, 0, 199);
  EXPECT_EQ(shorter.by_surrogate[0][0].path.size(), 19U);
  EXPECT_EQ(shorter.real[0].size(), 19U);
  EXPECT_TRUE(starts_of(rollouts(exact(622), {skidding()}, 0, 127)).empty());
  EXPECT_FALSE(starts_of(rollouts(exact(622), {skidding()}, 0, 128)).empty());
}

// ---- what the network sees ---------------------------------------------------------------------

/// A step forward of 0.01 m times this input over its range, and no turn.
Model forward_from(const char* input, double half_range) {
  return linear_model({channel(input, half_range)},
                      {channel("forward", 0.01), channel("delta_theta", 0.01)}, {1.0, 0.0},
                      {0.0, 0.0});
}

/// Position of the first rollout's robot when it has made ten frames, from its start on.
double made_in_ten_frames(const MadeUpDrive& drive, const Model& model) {
  const SessionRollouts result = rollouts(drive, {network(model)}, 1);
  return result.by_surrogate[0][0].path[0].x_m - 3 * kExact_m;
}

constexpr double kNear = 1e-5;

TEST(RolloutNetwork, SeesTheRecordedTracksOfEveryFrameFromTheStartOn) {
  MadeUpDrive drive = exact(200);
  drive.alter = [](std::size_t row, SimFrame& frame, SensorSample&) {
    frame.track_left = row == kBegin ? 0.1 : (row == kBegin + 1 ? 0.2 : 0.0);
    frame.track_right = row == kBegin ? 0.3 : (row == kBegin + 10 ? 0.05 : 0.0);
  };
  constexpr double kGain = 0.01 / 0.5;
  EXPECT_NEAR(made_in_ten_frames(drive, forward_from("track_left", 0.5)), 0.2 * kGain, kNear);
  EXPECT_NEAR(made_in_ten_frames(drive, forward_from("track_right", 0.5)), 0.05 * kGain, kNear);
}

TEST(RolloutNetwork, SeesTheMotionOfTheStart) {
  // The robot repeats what it did a frame ago.
  const Model model =
      linear_model({channel("pitch", 1.0)},
                   {channel("forward", 0.01, "forward@1"), channel("delta_theta", 0.01)},
                   {0.0, 0.0}, {0.0, 0.0});
  MadeUpDrive drive = exact(200);
  drive.alter = [](std::size_t row, SimFrame& frame, SensorSample&) {
    if (row == kBegin - 2) frame.delta_x = 0.001;
    if (row == kBegin - 1) frame.delta_x = 0.002;
    if (row == kBegin) frame.delta_x = 0.004;
    if (row == kBegin + 1) frame.delta_x = 0.009;
  };
  const SessionRollouts result = rollouts(drive, {network(model)}, 1);
  EXPECT_NEAR(result.by_surrogate[0][0].path[0].x_m, 0.007 + 10 * 0.004, kNear);
}

TEST(RolloutNetwork, SeesTheGroundThatTheRecordedRobotStoodOnAtTheStart) {
  MadeUpDrive drive = exact(200);
  const double slope = 0.1;
  const auto nodes_x = static_cast<std::size_t>(drive.ground.nx());
  for (std::size_t node = 0; node < nodes_x * static_cast<std::size_t>(drive.ground.ny()); ++node) {
    const double x = drive.ground.node_x(static_cast<int>(node % nodes_x));
    drive.changes.push_back({static_cast<std::uint32_t>(node),
                             static_cast<std::int32_t>(std::lround(slope * x / kHeightUnit_m))});
  }
  const Model model = forward_from("pitch", 0.5);
  const double uphill = 10 * 0.01 * std::atan(slope) / 0.5;
  drive.changed_at = kBegin;
  EXPECT_NEAR(made_in_ten_frames(drive, model), uphill, kNear);
  drive.changed_at = kBegin + 1;
  EXPECT_NEAR(made_in_ten_frames(drive, model), 0.0, kNear) << "it does not change afterwards";
}

// ---- what is refused ---------------------------------------------------------------------------

TEST(RolloutTracks, TakesNoSessionThatIsNotOnSoil) {
  MadeUpDrive rigid = exact(200);
  rigid.experiment = "[map]\nmodel = rigid\n";
  EXPECT_THROW(rollouts(rigid, {skidding()}), InputError);
}

}  // namespace
}  // namespace screed::nn
