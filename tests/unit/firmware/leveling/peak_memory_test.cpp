// Peak memory: it learns the heights of the ground that it drives over, goes to the high places and
// spins there, the longer the higher they are.
#include "firmware/leveling/peak_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/leveling/leveling.h"

namespace screed {
namespace {

constexpr double kAngleUnits = 65536.0 / (2.0 * std::numbers::pi);
constexpr int kHalf_mm = 750;

/// Ground as a function of the place, and a point on it that moves exactly as commanded.
class PeakMemoryOnAHill : public ::testing::Test {
 protected:
  static Parameters parameters() {
    Parameters parameters;
    parameters.algorithm = static_cast<int16_t>(LevelingAlgorithm::kPeakMemory);
    parameters.site_radius = 1200;
    parameters.site_x = kHalf_mm;
    parameters.site_y = kHalf_mm;
    parameters.spin_time = 4000;
    return parameters;
  }

  /// A hill of so many mm, north-east of the middle.
  double ground(double x, double y) const {
    const double away = std::hypot(x - 350.0, y - 200.0);
    return hill_mm_ * std::exp(-0.5 * away * away / (250.0 * 250.0));
  }

  void tick() {
    const double pitch = slope(std::cos(angle_), std::sin(angle_));
    const double roll = slope(-std::sin(angle_), std::cos(angle_));
    LevelingInput input{};
    input.pitch = to_units(pitch);
    input.roll = to_units(roll);
    input.heading = to_units(angle_);
    input.place.mm[kX] = static_cast<int16_t>(std::lround(x_));
    input.place.mm[kY] = static_cast<int16_t>(std::lround(y_));
    const LevelingState before = behaviour_.state();
    const MotionCommand motion = memory_.tick(input, behaviour_);
    if (behaviour_.state() == LevelingState::kSpin) {
      if (before != LevelingState::kSpin) ++spins_;
      ++spin_ticks_;
      spin_ground_ += ground(x_, y_);
    }
    angle_ += motion.yaw_rate / kAngleUnits / kTickRate_hz;
    x_ += motion.speed_mm_per_s * std::cos(angle_) / kTickRate_hz;
    y_ += motion.speed_mm_per_s * std::sin(angle_) / kTickRate_hz;
    farthest_mm_ = std::max({farthest_mm_, std::abs(x_), std::abs(y_)});
  }
  void drive(int seconds) {
    for (int i = 0; i < seconds * kTickRate_hz; ++i) tick();
  }
  double known(int x, int y) const {
    const int16_t place[2] = {static_cast<int16_t>(x), static_cast<int16_t>(y)};
    return memory_.height(place) / 32.0;
  }
  /// Mean of the ground over the site, mm.
  double mean_ground() const {
    double sum = 0.0;
    for (int y = -kHalf_mm; y < kHalf_mm; y += 25)
      for (int x = -kHalf_mm; x < kHalf_mm; x += 25) sum += ground(x, y);
    return sum / 3600.0;
  }

  double hill_mm_ = 50.0;
  PeakMemory memory_{parameters()};
  Behaviour behaviour_{parameters()};
  int spins_ = 0;
  int spin_ticks_ = 0;
  double spin_ground_ = 0.0;
  double farthest_mm_ = 0.0;

 private:
  double slope(double to_x, double to_y) const {
    return std::atan((ground(x_ + to_x, y_ + to_y) - ground(x_ - to_x, y_ - to_y)) / 2.0);
  }
  static Angle to_units(double angle) {
    return wrap_angle(static_cast<int32_t>(std::lround(angle * kAngleUnits)));
  }

  double x_ = 0.0;
  double y_ = 0.0;
  double angle_ = 1.0;
};

TEST_F(PeakMemoryOnAHill, KnowsNothingAtFirst) {
  for (const int x : {-2000, -700, 0, 333, 750}) EXPECT_EQ(known(x, 100), 0.0);
}

// It is where the slopes are driven over that heights are learnt: near the walls it seldom goes,
// and the map stays flatter than the ground.
TEST_F(PeakMemoryOnAHill, LearnsWhereTheGroundIsHigh) {
  drive(900);
  double products = 0.0;
  double known_squares = 0.0;
  double squares = 0.0;
  double highest = 0.0;
  int highest_x = 0;
  int highest_y = 0;
  for (int y = -600; y <= 600; y += 50) {
    for (int x = -600; x <= 600; x += 50) {
      const double truth = ground(x, y) - mean_ground();
      products += known(x, y) * truth;
      known_squares += known(x, y) * known(x, y);
      squares += truth * truth;
      if (known(x, y) <= highest) continue;
      highest = known(x, y);
      highest_x = x;
      highest_y = y;
    }
  }
  EXPECT_GT(products / std::sqrt(known_squares * squares), 0.85);
  EXPECT_GT(products / squares, 0.4) << "share of the heights that it knows";
  EXPECT_NEAR(highest_x, 350, 100);
  EXPECT_NEAR(highest_y, 200, 100);
}

TEST_F(PeakMemoryOnAHill, TheMeanOfTheMapStaysZero) {
  drive(300);
  double sum = 0.0;
  for (int y = -kHalf_mm; y < kHalf_mm; y += 25)
    for (int x = -kHalf_mm; x < kHalf_mm; x += 25) sum += known(x, y);
  // Bilinear between the heights, of which those at the edge count half.
  EXPECT_NEAR(sum / 3600.0, 0.0, 2.0);
}

TEST_F(PeakMemoryOnAHill, SpinsWhereItIsHighAndStaysOffTheWalls) {
  drive(300);
  spin_ticks_ = 0;
  spin_ground_ = 0.0;
  drive(600);
  ASSERT_GT(spin_ticks_, 60 * kTickRate_hz);
  EXPECT_GT(spin_ground_ / spin_ticks_, mean_ground() + 0.4 * hill_mm_);
  EXPECT_LT(farthest_mm_, kHalf_mm - 100);
}

TEST_F(PeakMemoryOnAHill, SpinsTheLongerTheHigherTheHill) {
  const auto mean_spin = [&] {
    drive(1200);
    spins_ = 0;
    spin_ticks_ = 0;
    drive(600);
    return static_cast<double>(spin_ticks_) / spins_;
  };
  hill_mm_ = 10.0;
  const double high = mean_spin();
  hill_mm_ = 4.0;  // worn down: it finds out
  // Not in proportion: spins too short to dig are left out.
  EXPECT_LT(mean_spin() / high, 0.75);
}

TEST_F(PeakMemoryOnAHill, OnLevelGroundItDrivesOn) {
  hill_mm_ = 0.0;
  drive(300);
  EXPECT_EQ(spin_ticks_, 0);
  EXPECT_GT(farthest_mm_, 300);
}

}  // namespace
}  // namespace screed
