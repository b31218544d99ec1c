// Rollouts that the firmware drives, beside sessions of the same surrogate: it has to follow
// itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/session/export.h"
#include "nn/surrogate/rollout.h"
#include "nn/surrogate/rollout_robot.h"
#include "tests/unit/nn/surrogate/linear_model.h"
#include "tests/unit/nn/surrogate/surrogate_session.h"

namespace screed::nn {
namespace {

constexpr std::size_t kRows = 3000;

SurrogateFactory skidding(double speed_share = 0.96) {
  return {"skid", [=] { return Surrogate(skid_of(speed_share), SupportGeometry{}, 1); }};
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

void expect_to_follow_itself(const std::string& board, const std::string& more = "") {
  const TempFolder folder;
  record_surrogate(folder.path() / "run", skidding().robot(), kRows, more, board);
  const SessionRollouts result =
      roll_out(folder.path() / "run", {skidding(), skidding(0.8)}, one_start());
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
  // Half full: there the voltage hardly depends on the charge, which a recording says to a few
  // parts in a million; the converter's last digit depends on those where the curve is steep.
  expect_to_follow_itself("zumo_32u4",
                          "[battery]\ncharge = 0.5\n[parameters]\nbattery_low = 4000\n");
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
  record_surrogate(folder.path() / "run", skidding().robot(), kRows);
  RolloutOptions options = one_start();
  for (const std::size_t frames : {2200U, 2199U}) {
    options.max_frames = frames;
    const SessionRollouts result = roll_out(folder.path() / "run", {skidding()}, options);
    EXPECT_EQ(result.by_surrogate[0].at(0).path.size(), frames / 10);
    EXPECT_EQ(result.real.at(0).size(), frames / 10);
  }
}

TEST(RolloutFirmware, MeasuresByItselfFromTheStartOn) {
  const TempFolder folder;
  const fs::path run = folder.path() / "run";
  const fs::path altered = folder.path() / "altered";
  record_surrogate(run, skidding().robot(), kRows);
  const Rollout rollout = roll_out(run, {skidding()}, one_start()).by_surrogate[0].at(0);
  const auto expect_same_path = [&](bool same) {
    const Rollout other = roll_out(altered, {skidding()}, one_start()).by_surrogate[0].at(0);
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
    for (int axis = 0; axis < 3; ++axis) sample.imu.gyro()[axis] = sample.imu.accel()[axis] = 0;
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

}  // namespace
}  // namespace screed::nn
