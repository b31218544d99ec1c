// Pre-processing against values computed by hand from the thesis' formulas.
#include "nn/data/preprocessing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "nn/data/features.h"

namespace screed::nn {
namespace {

FeatureTable table_of(const std::string& name, std::vector<double> values) {
  FeatureTable table;
  table.source = "test";
  table.names = {name};
  for (std::size_t i = 0; i < values.size(); ++i) table.frames.push_back(100 + i);
  table.columns = {std::move(values)};
  return table;
}

Preprocessing stages_of(const std::string& json) {
  const Json list = Json::parse(json);
  return Preprocessing(read_preprocessing_stages(JsonValue(list, "stages.json")));
}

std::string refusal(const std::string& json) {
  try {
    stages_of(json);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<double> learned(const std::string& json, std::vector<double> values) {
  std::vector<FeatureTable> tables = {table_of("v", std::move(values))};
  stages_of(json).learn(tables);
  return tables[0].columns[0];
}

TEST(PreprocessingStages, QuantisationIsThePrintedTable) {
  const std::pair<double, double> rows[] = {
      {-1.0, -0.8}, {-0.8, -0.8},  {-0.79, -0.6}, {-0.6, -0.6}, {-0.41, -0.4},
      {-0.4, -0.4}, {-0.39, -0.2}, {-0.2, -0.2},  {-0.19, 0.0}, {0.0, 0.0},
      {0.19, 0.0},  {0.2, 0.2},    {0.39, 0.2},   {0.4, 0.4},   {0.59, 0.4},
      {0.6, 0.6},   {0.79, 0.6},   {0.8, 0.8},    {1.0, 0.8}};
  for (const auto& [from, to] : rows) EXPECT_NEAR(quantised(from, 0.2), to, 1e-12) << from;
}

TEST(PreprocessingStages, NormalisationTakesTheMiddleNotHalfOfTheRange) {
  // 2..6: middle 4, half range 2. Half of the range alone would give 0..2.
  EXPECT_EQ(learned(R"([{"stage": "normalise"}])", {2.0, 3.0, 6.0}),
            (std::vector<double>{-1.0, -0.5, 1.0}));
}

TEST(PreprocessingStages, ExponentialSmoothing) {
  EXPECT_EQ(learned(R"([{"stage": "exponential", "alpha": 0.25}])", {4.0, 0.0, 8.0}),
            (std::vector<double>{4.0, 3.0, 4.25}));
}

TEST(PreprocessingStages, MeanIsCentredAndShorterAtTheEnds) {
  EXPECT_EQ(learned(R"([{"stage": "mean", "width": 3}])", {3.0, 6.0, 9.0, 0.0}),
            (std::vector<double>{4.5, 6.0, 5.0, 4.5}));
  // Of four, two lie before and one behind.
  EXPECT_EQ(learned(R"([{"stage": "mean", "width": 4}])", {4.0, 8.0, 0.0, 4.0, 8.0}),
            (std::vector<double>{6.0, 4.0, 4.0, 5.0, 4.0}));
}

TEST(PreprocessingStages, OutliersBeyondEndsThatStayThemselves) {
  EXPECT_EQ(learned(R"([{"stage": "remove_beyond", "feature": "v", "low": -1, "high": 2}])",
                    {-1.0, -1.1, 2.0, 2.1, 0.0}),
            (std::vector<double>{-1.0, 2.0, 0.0}));
}

TEST(PreprocessingStages, OutliersAboveTheMeanAreOnOneSide) {
  // Mean 2, deviation sqrt((4 + 0 + 4 + 0) / 4) = sqrt(2): 4 goes, 0 stays.
  EXPECT_EQ(
      learned(R"([{"stage": "remove_above", "feature": "v", "sigmas": 1}])", {0.0, 2.0, 4.0, 2.0}),
      (std::vector<double>{0.0, 2.0, 2.0}));
}

TEST(PreprocessingStages, OutliersFarOffGoAtExactlySoManySigmas) {
  // Mean 0, deviation 1: 1 and -1 are just as far, and go.
  EXPECT_EQ(learned(R"([{"stage": "remove_far", "feature": "v", "sigmas": 1}])",
                    {1.0, -1.0, 1.25, -1.25, 0.6614378277661477, -0.6614378277661477}),
            (std::vector<double>{0.6614378277661477, -0.6614378277661477}));
}

TEST(PreprocessingStages, WhatTrainingTaughtIsAppliedToOthers) {
  Preprocessing stages = stages_of(
      R"([{"stage": "remove_far", "feature": "v", "sigmas": 1.5}, {"stage": "normalise"},
          {"stage": "quantise", "step": 0.2}])");
  std::vector<FeatureTable> training = {table_of("v", {0.0, 2.0}), table_of("v", {4.0, 2.0})};
  stages.learn(training);
  ASSERT_EQ(stages.scales().size(), 1U);
  EXPECT_EQ(stages.scale_of("v").middle, 2.0);
  EXPECT_EQ(stages.scale_of("v").half_range, 2.0);
  // Mean 2, deviation sqrt(2): 4.2 is beyond 1.5 of them, 3.8 is not.
  FeatureTable test = table_of("v", {4.2, 3.8, 2.3});
  FeatureTable raw = test;
  stages.apply(test);
  EXPECT_EQ(test.frames, (std::vector<std::uint64_t>{101, 102}));
  EXPECT_NEAR(test.columns[0][0], 0.8, 1e-12);
  EXPECT_NEAR(test.columns[0][1], 0.0, 1e-12);
  stages.apply(raw, Preprocessing::Extent::kRaw);
  EXPECT_NEAR(raw.columns[0][0], 0.9, 1e-12);
  EXPECT_NEAR(raw.columns[0][1], 0.15, 1e-12);
}

TEST(PreprocessingStages, RefuseWithPlaceAndWhatIsAllowed) {
  EXPECT_EQ(refusal(R"([{"stage": "smooth"}])"),
            "stages.json: [0].stage: 'smooth'; allowed is remove_beyond, remove_above, remove_far, "
            "normalise, quantise, exponential, mean");
  EXPECT_EQ(refusal(R"([{"stage": "mean", "width": 0}])"),
            "stages.json: [0].width: 0; allowed is an integer 1 to 100000");
  EXPECT_EQ(refusal(R"([{"stage": "normalise"}, {"stage": "normalise"}])"),
            "stages.json: [1]: a second normalisation; allowed is one");
  EXPECT_THROW(learned(R"([{"stage": "normalise"}])", {1.0, 1.0}), InputError);
  EXPECT_THROW(
      learned(R"([{"stage": "remove_beyond", "feature": "v", "low": 5, "high": 6}])", {1.0}),
      InputError);
}

TEST(Features, ProductsAndMagnitudesAreOfTheFrameItself) {
  SimFrame frame;
  frame.v_left = -6.0;
  frame.v_right = 2.0;
  frame.pitch = -0.3;
  frame.roll = 0.4;
  frame.rate_x = -0.1;
  frame.rate_y = 0.2;
  frame.rate_z = -1.5;
  const FrameWindow now({&frame, 1});
  const auto value = [&](const char* name) { return NamedFeature(name).value(now); };
  EXPECT_EQ(value("speed"), 2.0);
  EXPECT_EQ(value("spin"), 8.0);
  EXPECT_NEAR(value("climb"), 2.0 * std::sin(0.3), 1e-12);  // backwards up a slope
  EXPECT_NEAR(value("lean"), 8.0 * std::sin(0.4), 1e-12);
  EXPECT_NEAR(value("slide"), -2.0 * std::sin(0.4), 1e-12);
  EXPECT_NEAR(value("pivot"), -8.0 * std::sin(0.3), 1e-12);
  EXPECT_EQ(value("roll_rate"), 0.1);
  EXPECT_EQ(value("pitch_rate"), 0.2);
  EXPECT_EQ(value("yaw_rate"), 1.5);
  EXPECT_EQ(value("arc"), 3.0);
}

TEST(Features, LookBackAndSubtract) {
  std::vector<SimFrame> frames(4);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].v_left = static_cast<double>(i);
    frames[i].v_right = 10.0;
    frames[i].delta_x = 3.0;
    frames[i].delta_y = 4.0;
  }
  const FrameWindow window{std::span<const SimFrame>(frames)};
  EXPECT_EQ(NamedFeature("v_left").value(window), 3.0);
  EXPECT_EQ(NamedFeature("v_left@2").value(window), 1.0);
  EXPECT_EQ(NamedFeature("v_left@9").value(window), 0.0);
  EXPECT_EQ(NamedFeature("v_left@2").frames(), 3U);
  EXPECT_EQ(NamedFeature("v_left-v_right@1").value(window), -7.0);
  EXPECT_EQ(NamedFeature("v").value(window), 5.0);
  for (const char* wrong : {"v_up", "v_left@x", "v_left@-1", "v_left@", "v-", ""}) {
    EXPECT_THROW(NamedFeature{wrong}, InputError) << wrong;
  }
}

}  // namespace
}  // namespace screed::nn
