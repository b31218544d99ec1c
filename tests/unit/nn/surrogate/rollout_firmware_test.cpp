// Rollouts that the firmware drives, beside sessions of the same surrogate: it has to follow
// itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/session/height_export.h"
#include "nn/surrogate/default_model.h"
#include "nn/surrogate/rollout.h"
#include "nn/surrogate/rollout_robot.h"
#include "nn/terrain/sinkage_replay.h"
#include "tests/unit/nn/surrogate/linear_model.h"
#include "tests/unit/nn/surrogate/surrogate_session.h"

namespace screed::nn {
namespace {

constexpr std::size_t kRows = 3000;

SurrogateFactory skidding(const SkidKinematics& kinematics) {
  return {"skid", [=] { return Surrogate(kinematics, SupportGeometry{}, 1); }};
}

RolloutOptions one_start() {
  RolloutOptions options;
  options.starts = 1;
  return options;
}

/// The greatest distance between a rollout's path and the recorded one.
double farthest(const SessionRollouts& result, std::size_t surrogate = 0,
                std::size_t strides = std::numeric_limits<std::size_t>::max()) {
  const std::vector<PlanarPose>& path = result.by_surrogate[surrogate].at(0).path;
  const std::vector<PlanarPose>& real = result.real.at(0);
  EXPECT_EQ(path.size(), real.size());
  EXPECT_GT(path.size(), 100U);
  double worst = 0.0;
  for (std::size_t i = 0; i < std::min({path.size(), real.size(), strides}); ++i) {
    worst = std::max(worst, std::hypot(path[i].x_m - real[i].x_m, path[i].y_m - real[i].y_m));
  }
  return worst;
}

void expect_to_follow_itself(const std::string& board) {
  const TempFolder folder;
  record_surrogate(folder.path() / "run", skidding(kNominalSkid).robot(), kRows, "", {}, board);
  const SessionRollouts result =
      roll_out(folder.path() / "run",
               {skidding(kNominalSkid), skidding({0.8, kNominalSkid.tread_m})}, one_start());
  EXPECT_EQ(result.source, "made_up");
  const RolloutCheck& same = result.by_surrogate[0].at(0).checks[0];
  EXPECT_TRUE(same.reached);
  EXPECT_LT(same.position_error, 5e-4);
  EXPECT_LT(same.heading_error_rad, 2e-3);
  EXPECT_LT(farthest(result), 2e-3);  // the last bits of the field turn the heading
  // Encoders do not notice that the robot slips.
  EXPECT_GT(farthest(result, 1), 0.05);
}

TEST(RolloutFirmware, FollowsASessionOfTheSameSurrogateAndNotOfAnother) {
  expect_to_follow_itself("a_star_32u4");
}

TEST(RolloutFirmware, FollowsASessionWithTheMotorsOfAnotherBoard) {
  expect_to_follow_itself("zumo_32u4");
}

/// The session with rows changed.
void alter(const fs::path& from, const fs::path& to,
           const std::function<void(std::size_t row, SensorSample&)>& change) {
  const SessionReader session(from / "session.h5");
  std::vector<SimFrame> frames(session.frames());
  std::vector<SensorSample> samples(session.frames());
  session.read(0, std::span(frames));
  session.read(0, std::span(samples));
  fs::create_directories(to);
  fs::copy_file(from / "experiment.ini", to / "experiment.ini");
  SessionWriter writer(to / "session.h5", session.info());
  writer.record_heights(session.heights_after(0).view());
  for (std::size_t row = 0; row < frames.size(); ++row) {
    change(row, samples[row]);
    writer.append(frames[row], samples[row], RobotOutput{});
  }
  writer.finish();
}

TEST(RolloutFirmware, EndsWithTheLastFrameItMayHave) {
  const TempFolder folder;
  record_surrogate(folder.path() / "run", skidding(kNominalSkid).robot(), kRows);
  RolloutOptions options = one_start();
  for (const std::size_t frames : {2200U, 2199U}) {
    options.max_frames = frames;
    const SessionRollouts result =
        roll_out(folder.path() / "run", {skidding(kNominalSkid)}, options);
    EXPECT_EQ(result.by_surrogate[0].at(0).path.size(), frames / 10);
    EXPECT_EQ(result.real.at(0).size(), frames / 10);
  }
}

TEST(RolloutFirmware, MeasuresByItselfFromTheStartOn) {
  const TempFolder folder;
  const fs::path run = folder.path() / "run";
  const fs::path altered = folder.path() / "altered";
  record_surrogate(run, skidding(kNominalSkid).robot(), kRows);
  const Rollout rollout =
      roll_out(run, {skidding(kNominalSkid)}, one_start()).by_surrogate[0].at(0);
  const auto expect_same_path = [&](bool same) {
    const Rollout other =
        roll_out(altered, {skidding(kNominalSkid)}, one_start()).by_surrogate[0].at(0);
    ASSERT_EQ(other.path.size(), rollout.path.size());
    bool equal = true;
    for (std::size_t i = 0; i < rollout.path.size(); ++i) {
      equal = equal && other.path[i].x_m == rollout.path[i].x_m &&
              other.path[i].heading_rad == rollout.path[i].heading_rad;
    }
    EXPECT_EQ(equal, same);
    fs::remove_all(altered);
  };
  const auto wipe = [](SensorSample& sample) {
    for (int axis = 0; axis < 3; ++axis) sample.gyro[axis] = sample.accel[axis] = 0;
    sample.encoder_left = sample.encoder_right = sample.battery = 0;
  };
  alter(run, altered, [&](std::size_t row, SensorSample& sample) {
    if (row > rollout.start) wipe(sample);
  });
  expect_same_path(true);
  // The firmware has received all samples up to the start.
  alter(run, altered, [&](std::size_t row, SensorSample& sample) {
    if (row >= rollout.start) wipe(sample);
  });
  expect_same_path(false);
}

// ---- deformable terrain ------------------------------------------------------------------------

struct OnRuts {
  OnRuts() { record_surrogate(run, robot.robot(), 1900, "", bearing); }
  SessionRollouts rollouts(std::size_t starts,
                           const std::shared_ptr<const BearingCapacityNetwork>& by) const {
    RolloutOptions options;
    options.starts = starts;
    options.bearing = by;
    return roll_out(run, {robot}, options);
  }

  TempFolder folder;
  fs::path run = folder.path() / "run";
  std::shared_ptr<const BearingCapacityNetwork> bearing =
      std::make_shared<const BearingCapacityNetwork>(
          BearingCapacityNetwork::read(default_bearing_capacity_file()));
  /// Tracks that do not slip, and slide down where the ground is inclined.
  SurrogateFactory robot{"network", [] {
                           const double turn = 0.01 * 0.5 / 0.127 / 0.1;
                           return Surrogate(
                               linear_model({channel("track_left", 0.5),
                                             channel("track_right", 0.5), channel("pitch", 0.5)},
                                            {channel("forward", 0.01), channel("delta_theta", 0.1)},
                                            {0.25, 0.25, -0.4, -turn, turn, 0.0}, {0.0, 0.0}),
                               SupportGeometry{}, 1);
                         }};
};

TEST(RolloutFirmware, OnTerrainThatItDeformsFollowsASessionThatDidSo) {
  const OnRuts ruts;
  // As far as the robot's second turn: to which side it turns there hangs on the last bits.
  constexpr std::size_t kStrides = 80;
  const double level = farthest(ruts.rollouts(1, nullptr), 0, kStrides);
  EXPECT_GT(level, 0.05) << "the terrain stays as it was";
  EXPECT_LT(farthest(ruts.rollouts(1, ruts.bearing), 0, kStrides), 0.3 * level);
}

TEST(RolloutFirmware, TheTerrainAtAStartIsPressedByTheStridesThatHaveEnded) {
  const OnRuts ruts;
  const RecordedDrive recording(ruts.run);
  const DriveStrides strides(ruts.run);
  SinkageReplay pressed(strides);
  const SessionInfo& info = recording.session.info();
  const Assembly model = make_robot_model(recording.experiment, info.board_name);
  PlantOptions options;
  options.soil = recording.soil;
  options.vehicle.motor = board_motor(info.board_name).motor;
  // Every 17 rows: strides of five frames end at some of them.
  const std::uint64_t rows = recording.frames.size() - recording.first - 2;
  const SessionRollouts result = ruts.rollouts(rows / 17, ruts.bearing);
  ASSERT_GT(result.by_surrogate[0].size(), 5U);
  for (const Rollout& rollout : result.by_surrogate[0]) {
    const std::size_t ended = strides.ended_before(rollout.start + 1);
    const HeightField sinkage = pressed.after(ended).sinkage();
    SurrogatePlant plant(field_of(recording.session.heights_after(rollout.start + 1)), model,
                         options, ruts.robot.robot());
    plant.enable_deformation(ruts.bearing, &sinkage);
    RolloutRobot robot(info, recording.experiment);
    for (std::uint64_t row = 0; row <= rollout.start; ++row) robot.follow(recording.samples[row]);
    plant.set_state(recording.state(rollout.start, robot.counts_per_turn()));
    for (std::uint64_t row = rollout.start + 1; row <= rollout.start + 200; ++row) {
      for (int i = 0; i < plant.steps_per_tick(); ++i) plant.step(robot.duty_ratio());
      robot.tick(plant, recording.samples[row]);
    }
    EXPECT_EQ(rollout.path.at(19).x_m, plant.pose().x_m) << rollout.start;
    EXPECT_EQ(rollout.path.at(19).heading_rad, plant.pose().heading_rad) << rollout.start;
  }
}

}  // namespace
}  // namespace screed::nn
