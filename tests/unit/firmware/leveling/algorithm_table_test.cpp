// The table of the leveling algorithms: every value of LEVELING.algorithm in the schema is a class
// that drives.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "firmware/leveling/leveling.h"
#include "firmware/parameters/parameters.h"
#include "tools/schema/dbc.h"

namespace screed {
namespace {

/// The algorithms as the schema's file lists them.
std::vector<schema::ValueName> algorithms() {
  for (const schema::DbcMessage& message :
       schema::read_dbc("firmware/protocol/screed.dbc").messages) {
    for (const schema::DbcSignal& signal : message.signals) {
      if (message.name == "LEVELING" && signal.name == "algorithm") return signal.values;
    }
  }
  return {};
}

Parameters parameters_of(int64_t algorithm) {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(algorithm);
  parameters.site_radius() = 1000;
  return parameters;
}

TEST(AlgorithmTable, EveryAlgorithmOfTheSchemaIsThereAndDrives) {
  ASSERT_GE(algorithms().size(), 4U);
  for (const schema::ValueName& it : algorithms()) {
    const Parameters parameters = parameters_of(it.value);
    EXPECT_TRUE(parameters.valid()) << it.name;
    EXPECT_TRUE(algorithm_in_build(parameters.algorithm())) << it.name;
    Leveling leveling(parameters);
    leveling.start();
    EXPECT_EQ(static_cast<int64_t>(leveling.algorithm()), it.value);
    EXPECT_EQ(leveling.state(), LevelingState::kIdle);
    leveling.tick({});
    EXPECT_NE(leveling.state(), LevelingState::kIdle) << it.name;
  }
}

TEST(AlgorithmTable, WhatIsNoAlgorithmIsAnInvalidParameterAndStands) {
  int64_t max = 0;
  for (const schema::ValueName& it : algorithms()) max = std::max(max, it.value);
  const Parameters parameters = parameters_of(max + 1);
  EXPECT_FALSE(parameters.valid());
  Leveling leveling(parameters);
  leveling.start();
  for (const int16_t x_mm : {int16_t{0}, int16_t{1100}}) {  // on its site and off it
    const MotionCommand motion = leveling.tick({8192, 0, {{x_mm, 0}, {0, 0}}, {100, 100}});
    EXPECT_EQ(motion.speed_mm_per_s, 0);
    EXPECT_EQ(motion.yaw_rate, 0);
    EXPECT_EQ(leveling.state(), LevelingState::kIdle);
  }
}

TEST(AlgorithmTable, TheFenceHoldsThoseThatKeepToTheSite) {
  std::vector<std::string> kept;
  for (const schema::ValueName& it : algorithms()) {
    Leveling leveling(parameters_of(it.value));
    leveling.start();
    leveling.tick({0, 0, {{1100, 0}, {0, 0}}, {0, 0}});
    if (leveling.state() == LevelingState::kReturn) kept.push_back(it.name);
  }
  std::vector<std::string> expected;
#define SCREED_KEPT(number, name, Name) \
  if (Name::kKeepsToSite) expected.emplace_back(#name);
  SCREED_LEVELING_ALGORITHM(SCREED_KEPT)
#undef SCREED_KEPT
  EXPECT_EQ(kept, expected);
  EXPECT_EQ(std::count(kept.begin(), kept.end(), "hill_sensing"), 1);
  EXPECT_EQ(std::count(kept.begin(), kept.end(), "drive"), 0);
}

TEST(AlgorithmTable, OneThatIsLeftOutOfABuildStands) {
  const Parameters parameters;
  Behaviour behaviour(parameters);
  Slot<HillSensing, false> left_out(parameters);
  const MotionCommand motion = left_out.tick({8192, 0, {{0, 0}, {0, 0}}, {0, 0}}, behaviour);
  EXPECT_EQ(motion.speed_mm_per_s, 0);
  EXPECT_EQ(behaviour.state(), LevelingState::kIdle);
  Slot<HillSensing, true> there(parameters);
  EXPECT_GT(there.tick({8192, 0, {{0, 0}, {0, 0}}, {0, 0}}, behaviour).speed_mm_per_s, 0);
  EXPECT_EQ(behaviour.state(), LevelingState::kClimb);
}

// As LEAVE_OUT of make names them.
TEST(AlgorithmTable, TheListOfWhatIsLeftOutIsReadByWords) {
  static_assert(lists("coverage training_drive", "training_drive"), "the last");
  static_assert(lists("coverage  training_drive ", "coverage"), "the first");
  static_assert(!lists("training_drive", "drive"), "the end of a word is no word");
  static_assert(!lists("drive2 hill", "drive"), "nor is its beginning");
  static_assert(!lists("", "drive"), "none");
  static_assert(words_of("") == 0 && words_of(" a  bc ") == 2, "words");
  EXPECT_TRUE(algorithm_in_build(static_cast<int16_t>(LevelingAlgorithm::kTrainingDrive)));
}

TEST(AlgorithmTable, TheParameterNamesThem) {
  const ParameterInfo& info = kParameterTable[0];
  ASSERT_STREQ(info.name, "algorithm");
  const std::string text = info.meaning;
  for (const schema::ValueName& it : algorithms()) {
    EXPECT_NE(text.find(", " + std::to_string(it.value) + " " + it.name), std::string::npos)
        << text;
  }
}

}  // namespace
}  // namespace screed
