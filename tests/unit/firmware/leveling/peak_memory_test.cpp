// Peak memory: it learns the heights of the ground that it drives over, goes to the high places and
// spins there, the longer the higher they are.
#include "firmware/leveling/peak_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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
    parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kPeakMemory);
    parameters.site_radius() = 1200;
    parameters.site_x() = kHalf_mm;
    parameters.site_y() = kHalf_mm;
    parameters.spin_time() = 4000;
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

/// A robot that is put anywhere, on a slope as told. Heights are 128 mm apart to the east and 256
/// mm to the north, the first ones at the walls.
class PeakMemoryByHand : public ::testing::Test {
 protected:
  static constexpr int kEast_mm = 704;
  static constexpr int kNorth_mm = 1408;
  static constexpr double kDegree = std::numbers::pi / 180.0;
  /// A 16th of the rise from one height to the next on 20 degrees.
  static constexpr double kStepEast_mm = 20.0 * kDegree * 128.0 / 16.0;
  static constexpr double kStepNorth_mm = 20.0 * kDegree * 256.0 / 16.0;

  static Parameters parameters() {
    Parameters parameters;
    parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kPeakMemory);
    parameters.site_x() = kEast_mm;
    parameters.site_y() = kNorth_mm;
    parameters.random_seed() = 5;
    return parameters;
  }
  static Angle units(double degrees) {
    return static_cast<Angle>(std::lround(degrees * kDegree * kAngleUnits));
  }
  /// Where the heights are, counted from the south-west.
  static int node_x(int east) { return -kEast_mm + 128 * east; }
  static int node_y(int north) { return -kNorth_mm + 256 * north; }

  void put(int x, int y) {
    input_.place.mm[kX] = static_cast<int16_t>(x);
    input_.place.mm[kY] = static_cast<int16_t>(y);
  }
  /// Pitch and roll on ground that rises so many degrees to the east and to the north.
  void lean(double east_deg, double north_deg) {
    const double angle = input_.heading / kAngleUnits;
    input_.pitch = units(east_deg * std::cos(angle) + north_deg * std::sin(angle));
    input_.roll = units(-east_deg * std::sin(angle) + north_deg * std::cos(angle));
  }
  void tick() {
    const LevelingState before = behaviour_.state();
    motion_ = memory_.tick(input_, behaviour_);
    if (behaviour_.state() == LevelingState::kSpin && before != LevelingState::kSpin) ++spins_;
  }
  void ticks(int count) {
    for (int i = 0; i < count; ++i) tick();
  }
  int16_t known_units(int x, int y) const {
    const int16_t place[2] = {static_cast<int16_t>(x), static_cast<int16_t>(y)};
    return memory_.height(place);
  }
  double known(int x, int y) const { return known_units(x, y) / 32.0; }

  /// Which way it would turn if it were there.
  YawRate turn_at(int x, int y, Angle heading) const {
    PeakMemory memory = memory_;
    Behaviour behaviour = behaviour_;
    LevelingInput input = input_;
    input.place.mm[kX] = static_cast<int16_t>(x);
    input.place.mm[kY] = static_cast<int16_t>(y);
    input.heading = heading;
    return memory.tick(input, behaviour).yaw_rate;
  }
  /// Where it drives to: from the south it lies straight to the north, from the west to the east.
  std::array<int, 2> target() const {
    std::array<int, 2> found{-kEast_mm, -kNorth_mm};
    while (found[kX] < kEast_mm && turn_at(found[kX], -3000, kQuarterTurn) < 0) ++found[kX];
    while (found[kY] < kNorth_mm && turn_at(-3000, found[kY], 0) > 0) ++found[kY];
    return found;
  }
  /// Another journey begins.
  void journey() {
    behaviour_.enter_or_stay(LevelingState::kReturn, {0, 0});
    tick();
  }
  /// A ridge from south to north, in the eastern half.
  void learn_a_ridge() {
    for (int round = 0; round < 30; ++round) {
      for (int north = 0; north < 11; ++north) {
        for (int east = 0; east < 11; ++east) {
          put(node_x(east) + 64, node_y(north) + 128);
          lean(east < 6 ? 3.0 : -4.0, 0.0);
          ticks(8);
          behaviour_.start();
        }
      }
    }
    lean(0.0, 0.0);
  }
  bool spins_at(int x, int y) const {
    PeakMemory memory = memory_;
    Behaviour behaviour = behaviour_;
    LevelingInput input = input_;
    input.place.mm[kX] = static_cast<int16_t>(x);
    input.place.mm[kY] = static_cast<int16_t>(y);
    memory.tick(input, behaviour);
    return behaviour.state() == LevelingState::kSpin;
  }

  PeakMemory memory_{parameters()};
  Behaviour behaviour_{parameters()};
  LevelingInput input_{};
  MotionCommand motion_{};
  int spins_ = 0;
};

TEST_F(PeakMemoryByHand, LearnsEveryEighthTick) {
  lean(20.0, 0.0);
  put(node_x(5), node_y(5));
  double before = 0.0;
  for (int time = 0; time < 3; ++time) {
    ticks(7);
    EXPECT_EQ(known(node_x(6), node_y(5)), before) << time;
    tick();
    EXPECT_GT(known(node_x(6), node_y(5)), before + 1.0) << time;
    before = known(node_x(6), node_y(5));
  }
}

TEST_F(PeakMemoryByHand, EachHeightIsCorrectedByASixteenthOfTheError) {
  lean(20.0, 0.0);
  put(node_x(5), node_y(5));
  ticks(8);
  EXPECT_NEAR(known(node_x(6), node_y(5)), kStepEast_mm, 0.05);
  // That it is level to the north corrects a sixteenth of what this one fell by.
  EXPECT_NEAR(known(node_x(5), node_y(5)), -kStepEast_mm * 15 / 16, 0.05);
  EXPECT_NEAR(known(node_x(5), node_y(6)), -kStepEast_mm / 16, 0.05);
  for (int north = 0; north < 12; ++north) {
    for (int east = 0; east < 12; ++east) {
      if ((north == 5 && (east == 5 || east == 6)) || (north == 6 && east == 5)) continue;
      EXPECT_EQ(known(node_x(east), node_y(north)), 0.0) << east << " " << north;
    }
  }
  ticks(8);  // what it knows by then is some eighth of the rise
  EXPECT_NEAR(known(node_x(6), node_y(5)), 1.88 * kStepEast_mm, 0.1);
}

TEST_F(PeakMemoryByHand, ASlopeToTheNorthAsWell) {
  lean(0.0, 20.0);
  put(node_x(5), node_y(5));
  ticks(8);
  EXPECT_NEAR(known(node_x(5), node_y(6)), kStepNorth_mm, 0.1);
  EXPECT_NEAR(known(node_x(5), node_y(5)), -kStepNorth_mm, 0.1);
  EXPECT_EQ(known(node_x(6), node_y(5)), 0.0);
  EXPECT_EQ(known(node_x(6), node_y(6)), 0.0);
}

TEST_F(PeakMemoryByHand, WhicheverWayItFaces) {
  for (const double heading_deg : {30.0, 90.0, 180.0, -120.0}) {
    memory_ = PeakMemory{parameters()};
    input_.heading = units(heading_deg);
    lean(20.0, 0.0);
    put(node_x(5), node_y(5));
    ticks(8);
    EXPECT_NEAR(known(node_x(6), node_y(5)), kStepEast_mm, 0.1) << heading_deg;
    // That it is level to the north corrects a sixteenth of what this one fell by.
    EXPECT_NEAR(known(node_x(5), node_y(5)), -kStepEast_mm * 15 / 16, 0.1) << heading_deg;
    EXPECT_NEAR(known(node_x(5), node_y(6)), -kStepEast_mm / 16, 0.1) << heading_deg;
  }
}

// The nearer a pair of heights is the more of the step it takes.
TEST_F(PeakMemoryByHand, TheNearerPairTakesMoreOfTheStep) {
  put(node_x(5) + 96, node_y(5) + 64);  // three quarters east, one quarter north
  lean(20.0, 0.0);
  ticks(8);
  EXPECT_NEAR(known(node_x(5), node_y(5)), -0.75 * kStepEast_mm, 0.1);
  EXPECT_NEAR(known(node_x(6), node_y(5)), 0.75 * kStepEast_mm, 0.1);
  EXPECT_NEAR(known(node_x(5), node_y(6)), -0.25 * kStepEast_mm, 0.1);
  EXPECT_NEAR(known(node_x(6), node_y(6)), 0.25 * kStepEast_mm, 0.1);
  EXPECT_EQ(known(node_x(7), node_y(5)), 0.0);
  EXPECT_EQ(known(node_x(7), node_y(6)), 0.0);
  EXPECT_EQ(known(node_x(5), node_y(4)), 0.0);
  EXPECT_EQ(known(node_x(5), node_y(7)), 0.0);

  memory_ = PeakMemory{parameters()};
  lean(0.0, 20.0);
  ticks(8);
  EXPECT_NEAR(known(node_x(5), node_y(5)), -0.25 * kStepNorth_mm, 0.1);
  EXPECT_NEAR(known(node_x(5), node_y(6)), 0.25 * kStepNorth_mm, 0.1);
  EXPECT_NEAR(known(node_x(6), node_y(5)), -0.75 * kStepNorth_mm, 0.1);
  EXPECT_NEAR(known(node_x(6), node_y(6)), 0.75 * kStepNorth_mm, 0.1);
  EXPECT_EQ(known(node_x(7), node_y(5)), 0.0);
  EXPECT_EQ(known(node_x(7), node_y(6)), 0.0);
}

TEST_F(PeakMemoryByHand, BetweenTheHeightsTheGroundIsBilinear) {
  put(node_x(5), node_y(5));
  lean(20.0, 10.0);
  ticks(80);
  const auto corner = [&](int east, int north) { return known(node_x(east), node_y(north)); };
  ASSERT_GT(std::abs(corner(5, 5)), 1.0);
  EXPECT_NEAR(known(node_x(5) + 64, node_y(5)), 0.5 * (corner(5, 5) + corner(6, 5)), 0.1);
  EXPECT_NEAR(known(node_x(5) + 32, node_y(5)), 0.75 * corner(5, 5) + 0.25 * corner(6, 5), 0.1);
  EXPECT_NEAR(known(node_x(5), node_y(5) + 64), 0.75 * corner(5, 5) + 0.25 * corner(5, 6), 0.1);
  EXPECT_NEAR(known(node_x(5) + 64, node_y(5) + 128),
              0.25 * (corner(5, 5) + corner(6, 5) + corner(5, 6) + corner(6, 6)), 0.1);
}

// Ground that rises all the way: in the end every difference is right, up to the walls.
TEST_F(PeakMemoryByHand, KnowsTheWholeRiseFromWallToWall) {
  for (int round = 0; round < 1500; ++round) {
    for (int east = 0; east < 11; ++east) {
      put(node_x(east) + 64, 0);
      lean(10.0, 0.0);
      ticks(8);
      behaviour_.start();  // on at once, wherever it arrived
    }
  }
  const double rise = 10.0 * kDegree * 2 * kEast_mm;
  EXPECT_NEAR(known(kEast_mm, 0) - known(-kEast_mm, 0), rise, 0.05 * rise);
  EXPECT_NEAR(known(0, 0), 0.0, 1.0);
}

TEST_F(PeakMemoryByHand, BeyondAWallThereIsTheGroundBesideIt) {
  put(2000, 0);
  lean(20.0, 0.0);
  ticks(80);
  const int16_t at_wall = known_units(kEast_mm, 0);
  EXPECT_GT(at_wall, 32);
  EXPECT_EQ(known_units(2000, 0), at_wall);
  EXPECT_EQ(known_units(kEast_mm - 1, 0), at_wall);
  EXPECT_LT(known_units(kEast_mm - 2, 0), at_wall);
  EXPECT_LT(known(node_x(10), 0), -1.0);
  for (const int y : {-300, 0, 100, 300}) EXPECT_EQ(known_units(-kEast_mm, y), 0) << y;
}

// On level ground all of them are as high.
TEST_F(PeakMemoryByHand, DrivesToTheFirstOfEightPlacesThatAreAsHigh) {
  Random random(static_cast<uint16_t>(parameters().random_seed()));
  const SiteRectangle site(parameters());
  for (int i = 0; i < 3; ++i) {
    journey();
    int16_t first[2];
    site.draw_place(random, 150, first);
    const std::array<int, 2> to = target();
    EXPECT_EQ(to[kX], first[kX]) << i;
    EXPECT_EQ(to[kY], first[kY]) << i;
    for (int other = 1; other < 8; ++other) site.draw_place(random, 150, first);
  }
}

TEST_F(PeakMemoryByHand, DrivesToTheHighestOfEightPlaces) {
  learn_a_ridge();
  // As often as it has chosen until then.
  Random random(static_cast<uint16_t>(parameters().random_seed()));
  const SiteRectangle site(parameters());
  const auto highest_of_eight = [&] {
    std::array<int, 2> highest{};
    for (int place = 0; place < 8; ++place) {
      int16_t mm[2];
      site.draw_place(random, 150, mm);
      if (place == 0 || known_units(mm[kX], mm[kY]) > known_units(highest[kX], highest[kY]))
        highest = {mm[kX], mm[kY]};
    }
    return highest;
  };
  journey();
  const std::array<int, 2> present = target();
  int journeys = 0;
  while (highest_of_eight() != present && journeys < 10000) ++journeys;
  ASSERT_LT(journeys, 10000);
  for (int i = 0; i < 3; ++i) {
    journey();
    EXPECT_EQ(target(), highest_of_eight()) << i;
  }
}

TEST_F(PeakMemoryByHand, GivesUpAPlaceAfterTwelveSeconds) {
  put(-kEast_mm, -kNorth_mm);
  for (int i = 0; i < 3; ++i) {
    tick();
    const std::array<int, 2> to = target();
    ticks(12 * kTickRate_hz - 2);
    EXPECT_EQ(target(), to) << i;
    tick();
    EXPECT_NE(target(), to) << i;
  }
}

TEST_F(PeakMemoryByHand, ArrivesWithin60mm) {
  learn_a_ridge();
  journey();
  const std::array<int, 2> to = target();
  for (const int away : {-59, 0, 59}) {
    EXPECT_TRUE(spins_at(to[kX] + away, to[kY])) << away;
    EXPECT_TRUE(spins_at(to[kX], to[kY] + away)) << away;
    EXPECT_TRUE(spins_at(to[kX] + away, to[kY] - away)) << away;
  }
  for (const int away : {-150, -60, 60, 150}) {
    EXPECT_FALSE(spins_at(to[kX] + away, to[kY])) << away;
    EXPECT_FALSE(spins_at(to[kX], to[kY] + away)) << away;
  }
}

TEST_F(PeakMemoryByHand, SpinsFor300msForEachMmToTheRightAndToTheLeftInTurn) {
  learn_a_ridge();
  for (int spin = 0; spin < 4; ++spin) {
    std::array<int, 2> to{};
    double height = 0.0;
    for (int places = 0; places < 100 && height < 3.0; ++places) {
      journey();
      to = target();
      height = known(to[kX], to[kY]);
    }
    ASSERT_GT(height, 3.0);
    put(to[kX], to[kY]);
    tick();
    EXPECT_EQ(behaviour_.state(), LevelingState::kSpin);
    EXPECT_EQ(motion_.speed_mm_per_s, 0);
    EXPECT_EQ(motion_.yaw_rate, 0);
    int count = 0;
    for (tick(); behaviour_.state() == LevelingState::kSpin && count < 3000; tick()) {
      EXPECT_EQ(motion_.speed_mm_per_s, 0);
      EXPECT_EQ(motion_.yaw_rate, (spins_ % 2 == 1 ? -1 : 1) * yaw_rate_from_degrees(90));
      ++count;
    }
    EXPECT_NEAR(count / std::min(30.0 * height, 400.0), 1.0, 0.04) << height;
    EXPECT_EQ(behaviour_.state(), LevelingState::kWalk);
  }
}

TEST_F(PeakMemoryByHand, ASpinTakes300msAtLeast) {
  for (const int spin_time : {299, 300}) {
    Parameters shorter = parameters();
    shorter.spin_time() = static_cast<int16_t>(spin_time);
    memory_ = PeakMemory{shorter};
    learn_a_ridge();
    journey();
    const std::array<int, 2> to = target();
    EXPECT_EQ(spins_at(to[kX], to[kY]), spin_time == 300) << spin_time;
  }
}

}  // namespace
}  // namespace screed
