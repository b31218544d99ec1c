// Algorithm 5: block by block, frame by frame, against the algorithm as it is printed.
#include "firmware/leveling/training_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <utility>
#include <vector>

#include "firmware/leveling/leveling.h"

namespace screed {
namespace {

Parameters parameters_of(int16_t block, int16_t seed) {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kTrainingDrive);
  parameters.training_block() = block;
  parameters.random_seed() = seed;
  return parameters;
}

std::vector<MotionCommand> drive(int16_t block, int16_t seed) {
  TrainingDrive training(parameters_of(block, seed));
  std::vector<MotionCommand> motions;
  for (;;) {
    const MotionCommand motion = training.tick();
    if (training.finished()) return motions;
    motions.push_back(motion);
  }
}

int sign(int value) {
  return (value > 0 ? 1 : 0) - (value < 0 ? 1 : 0);
}

/// The signs of l and omega at frame i of n, read off the printed algorithm.
std::pair<int, int> printed(int i, int n) {
  if (8 * i <= n) return {1, 0};
  if (8 * i < 2 * n) return {-1, 0};
  if (8 * i < 3 * n) return {0, 1};
  if (8 * i < 4 * n) return {0, -1};
  if (8 * i < 5 * n) return {1, 1};
  if (8 * i < 6 * n) return {-1, -1};
  if (8 * i < 7 * n) return {-1, 1};
  return {1, -1};
}

TEST(TrainingDrive, DrivesTheEightBlocksOfThePrintedAlgorithm) {
  for (const int block : {1, 2, 31, 250, 2000, 8000}) {
    const std::vector<MotionCommand> motions = drive(static_cast<int16_t>(block), 1);
    const int n = 8 * block;
    ASSERT_EQ(motions.size(), static_cast<size_t>(n));
    for (int i = 0; i < n; ++i) {
      const auto [l, omega] = printed(i, n);
      const MotionCommand& motion = motions[static_cast<size_t>(i)];
      ASSERT_EQ(sign(motion.speed_mm_per_s), l) << "frame " << i << " of " << n;
      ASSERT_EQ(sign(motion.yaw_rate), omega) << "frame " << i << " of " << n;
    }
  }
}

TEST(TrainingDrive, DrawsANewShareOfFullSpeedEvery250Frames) {
  const std::vector<MotionCommand> motions = drive(2000, 7);
  std::set<int> speeds;
  for (size_t i = 0; i < 2001; ++i) {
    const int speed = motions[i].speed_mm_per_s;
    if (i % 250 != 0) {
      EXPECT_EQ(speed, motions[i - 1].speed_mm_per_s) << i;
    }
    speeds.insert(speed);
  }
  EXPECT_GE(speeds.size(), 8U);  // of nine draws two may be alike
  // A share goes on over the end of a block that is no multiple of 250 frames.
  const std::vector<MotionCommand> odd = drive(300, 7);
  EXPECT_EQ(std::abs(odd[301].speed_mm_per_s), std::abs(odd[300].speed_mm_per_s));
  EXPECT_NE(std::abs(odd[500].speed_mm_per_s), std::abs(odd[499].speed_mm_per_s));
}

TEST(TrainingDrive, SharesAreUniformFromAQuarterToOne) {
  constexpr int kDraws = 1048;
  double sum = 0.0;
  int least = TrainingDrive::kFullSpeed_mm_per_s;
  int most = 0;
  const std::vector<MotionCommand> motions = drive(32750, 3);
  for (int draw = 0; draw < kDraws; ++draw) {
    const MotionCommand& motion = motions[static_cast<size_t>(draw) * 250];
    const double share = motion.speed_mm_per_s != 0 ? std::abs(motion.speed_mm_per_s) / 250.0
                                                    : std::abs(motion.yaw_rate) / 16384.0;
    sum += share;
    if (motion.speed_mm_per_s == 0) continue;
    least = std::min(least, std::abs(static_cast<int>(motion.speed_mm_per_s)));
    most = std::max(most, std::abs(static_cast<int>(motion.speed_mm_per_s)));
  }
  EXPECT_NEAR(sum / kDraws, 0.625, 4.0 * 0.2165 / std::sqrt(kDraws));  // four standard errors
  EXPECT_GE(least, 62);
  EXPECT_LE(least, 64);
  EXPECT_GE(most, 248);
  EXPECT_LE(most, 250);
}

TEST(TrainingDrive, TheSeedDecidesTheDrive) {
  const auto speeds = [](int16_t seed) {
    std::vector<int> all;
    for (const MotionCommand& motion : drive(2000, seed)) all.push_back(motion.speed_mm_per_s);
    return all;
  };
  EXPECT_EQ(speeds(1), speeds(1));
  EXPECT_NE(speeds(1), speeds(2));
}

TEST(TrainingDrive, TheRobotStandsWhenAllBlocksAreDriven) {
  Leveling leveling(parameters_of(2, 1));
  leveling.start();
  const LevelingInput input{};
  for (int i = 0; i < 16; ++i) {
    const MotionCommand motion = leveling.tick(input);
    EXPECT_EQ(leveling.state(), LevelingState::kTrainingDrive);
    EXPECT_TRUE(motion.speed_mm_per_s != 0 || motion.yaw_rate != 0);
  }
  for (int i = 0; i < 3; ++i) {
    const MotionCommand motion = leveling.tick(input);
    EXPECT_EQ(leveling.state(), LevelingState::kDone);
    EXPECT_EQ(motion.speed_mm_per_s, 0);
    EXPECT_EQ(motion.yaw_rate, 0);
  }
}

TEST(TrainingDrive, AStopInBetweenLosesNoFrame) {
  Leveling leveling(parameters_of(2, 1));
  int frames = 0;
  for (int run = 0; run < 4; ++run) {
    leveling.start();
    for (int i = 0; i < 5; ++i) {
      leveling.tick({});
      frames += leveling.state() == LevelingState::kTrainingDrive ? 1 : 0;
    }
  }
  EXPECT_EQ(frames, 16);
}

}  // namespace
}  // namespace screed
