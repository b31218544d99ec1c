// The slip watch's network learns from drives which ticks are those of a robot that hardly moves.
#include "nn/slip/slip_training.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "host_sim/core/errors.h"
#include "nn/slip/slip_examples.h"

namespace screed::nn {
namespace {

constexpr std::int16_t kLost = 12000;  // inputs of a robot that hardly moves, and of a free one
constexpr std::int16_t kKept = 1500;

/// Four seconds free and four held, in turn; only the first input tells which.
SlipRun drive_in_turn(std::size_t ticks) {
  SlipRun run;
  for (std::size_t i = 0; i < ticks; ++i) {
    const bool held = i / 400 % 2 == 1;
    SlipTick tick{};
    tick.inputs.fill(static_cast<std::int16_t>(i * 37 % 1000));
    tick.inputs[0] =
        static_cast<std::int16_t>((held ? kLost : kKept) + static_cast<int>(i % 7) * 10);
    tick.running = true;
    tick.evaluated = true;
    tick.faster_track = 0.2F;
    tick.speed = held ? 0.01F : 0.19F;
    run.ticks.push_back(tick);
  }
  return run;
}

std::int16_t output(const Model& model, std::int16_t first) {
  std::array<std::int16_t, kSlipInputs> in{};
  in.fill(500);
  in[0] = first;
  std::array<std::int16_t, 1> out{};
  model.networks.at(0).network.run(in, out);
  return out[0];
}

TEST(SlipTraining, ARobotThatHardlyMovesIsHeldAndOneThatMovesIsNot) {
  SlipTrainingOptions options;
  options.epochs = 6;
  const Model model = train_slip({drive_in_turn(8000)}, options);
  EXPECT_GT(output(model, kLost), 8000) << "held: the odds are high";
  EXPECT_LT(output(model, kKept), -8000) << "free";
}

TEST(SlipTraining, TheErrorFalls) {
  SlipTrainingOptions options;
  options.epochs = 24;
  std::vector<double> errors;
  options.progress = [&](std::size_t epoch, double error) {
    EXPECT_EQ(epoch, errors.size() + 1);
    errors.push_back(error);
  };
  train_slip({drive_in_turn(8000)}, options);
  ASSERT_EQ(errors.size(), 24U);
  EXPECT_LT(errors.front(), 1.0) << "a guess has ln 2";
  EXPECT_LT(errors.back(), 0.2);
  EXPECT_LT(errors.back(), errors.front());
  EXPECT_GT(errors.back(), 0.0);
}

TEST(SlipTraining, TheErrorIsTheMeanCrossEntropy) {
  const std::vector<float> logits = {0.0F, 2.0F, -3.0F, 50.0F, -80.0F};
  const std::vector<float> wanted = {1.0F, 1.0F, 1.0F, 0.0F, 0.0F};
  // -ln p of what was wanted, p = 1 / (1 + exp(-logit)) the odds' probability.
  const double expected =
      (std::log(2.0) + std::log1p(std::exp(-2.0)) + std::log1p(std::exp(3.0)) + 50.0 + 0.0) / 5.0;
  EXPECT_NEAR(mean_cross_entropy(logits, wanted), expected, 1e-6);
}

TEST(SlipTraining, TheModelGivesHalfTheLogOfTheOddsThatItWasTrainedFor) {
  SlipTrainingOptions options;
  options.epochs = 1;
  options.seed = 7;
  double error = 0.0;
  options.progress = [&](std::size_t /*epoch*/, double of_epoch) { error = of_epoch; };
  // Mostly free: what does not depend on the inputs is no longer nothing.
  SlipRun free = drive_in_turn(6000);
  for (SlipTick& tick : free.ticks) tick.speed = 0.19F;
  const std::vector<SlipRun> runs = {drive_in_turn(3000), free};
  const Model model = train_slip(runs, options);
  EXPECT_EQ(model.name, "slip");
  EXPECT_NE(model.description.find("hardly moves"), std::string::npos);
  EXPECT_EQ(model.networks.at(0).golden.size(), 12U) << "four of the ends, and eight";
  EXPECT_EQ(model.seed, 7U);
  ASSERT_EQ(model.networks.size(), 1U);
  const ModelNetwork& network = model.networks[0];
  ASSERT_EQ(network.inputs.size(), kSlipInputs);
  ASSERT_EQ(network.outputs.size(), 1U);
  const Examples examples = slip_examples(runs);
  std::vector<float> logits;
  for (std::size_t row = 0; row < examples.rows(); ++row) {
    std::vector<double> in;
    for (std::size_t i = 0; i < kSlipInputs; ++i) {
      in.push_back(static_cast<double>(examples.in[row * kSlipInputs + i]));
    }
    // The float network before its rounding to integers.
    logits.push_back(static_cast<float>(2.0 * screed::nn::run(network.trained, in).at(0)));
  }
  EXPECT_NEAR(mean_cross_entropy(logits, examples.out), error, 1e-5);
  EXPECT_GT(error, 1e-3);
}

TEST(SlipTraining, RangesAreThoseOfTheWatchsUnits) {
  // What a unit of each input is worth (slip_watch.h): 16 bits hold 32768 of them.
  struct Unit {
    const char* name;
    double worth;
  };
  constexpr double kShare = 1.0 / 16384.0;
  constexpr double kShaking = 1.0 / 128.0;
  const Unit units[] = {
      {"inertial_slip_3s", kShare}, {"inertial_slip_10s", kShare}, {"turn", kShare},
      {"track_difference", kShare}, {"faster_track", 0.2e-3},  // 0.2 mm/s
      {"sin_pitch", kShare},        {"effort", 1.0 / 16.0},        {"shaking_pitch_rate", kShaking},
      {"shaking_ahead", kShaking},  {"shaking_up", kShaking},      {"pitch_rate", 1.0 / 64.0}};
  SlipTrainingOptions options;
  options.epochs = 1;
  const ModelNetwork network = train_slip({drive_in_turn(5000)}, options).networks.at(0);
  ASSERT_EQ(network.inputs.size(), std::size(units));
  for (std::size_t i = 0; i < std::size(units); ++i) {
    EXPECT_EQ(network.inputs[i].feature, units[i].name);
    EXPECT_DOUBLE_EQ(network.inputs[i].half_range, 32768.0 * units[i].worth) << units[i].name;
    EXPECT_EQ(network.inputs[i].middle, 0.0) << units[i].name;
  }
  ASSERT_EQ(network.outputs.size(), 1U);
  EXPECT_EQ(network.outputs[0].feature, "held");
  EXPECT_EQ(network.outputs[0].half_range, 2.0);
  EXPECT_EQ(network.outputs[0].middle, 0.0);
}

TEST(SlipTraining, TicksAtRestOrTooSlowToBeLookedAtTeachNothing) {
  for (const bool running : {false, true}) {
    SlipRun run = drive_in_turn(8000);
    for (SlipTick& tick : run.ticks) {
      tick.running = running;
      tick.evaluated = !running;
    }
    EXPECT_THROW(train_slip({run}, {}), RunError);
  }
  EXPECT_THROW(train_slip({drive_in_turn(3900)}, {}), RunError)
      << "every fourth tick is an example";
  SlipTrainingOptions options;
  options.epochs = 1;
  SlipRun free = drive_in_turn(4027);
  for (SlipTick& tick : free.ticks) tick.speed = 0.19F;
  ASSERT_EQ(slip_examples({free}).rows(), 1000U);
  EXPECT_NO_THROW(train_slip({free}, options));
}

TEST(SlipTraining, TheDataIsKnownByItsInputsAndByItsLabels) {
  SlipTrainingOptions options;
  options.epochs = 1;
  const SlipRun run = drive_in_turn(5000);
  const std::string data = train_slip({run}, options).training_data;
  SlipRun other = run;
  other.ticks[19].inputs[5] += 100;
  EXPECT_NE(train_slip({other}, options).training_data, data);
  SlipRun relabelled = run;
  for (size_t i = 0; i < 300; ++i) relabelled.ticks[i].speed = 0.01F;
  EXPECT_NE(train_slip({relabelled}, options).training_data, data);
}

TEST(SlipTraining, TheSameDrivesGiveTheSameModel) {
  SlipTrainingOptions options;
  options.epochs = 1;
  const Model one = train_slip({drive_in_turn(5000)}, options);
  const Model two = train_slip({drive_in_turn(5000)}, options);
  EXPECT_EQ(one.training_data, two.training_data);
  EXPECT_EQ(output(one, kLost), output(two, kLost));
  EXPECT_NE(train_slip({drive_in_turn(5200)}, options).training_data, one.training_data);
}

}  // namespace
}  // namespace screed::nn
