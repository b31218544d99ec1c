// A network of motion learns along stretches of its own predictions: gradients against differences,
// and a law that can be learned is.
#include "nn/surrogate/motion_trainer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/surrogate/motion_configuration.h"

namespace screed::nn {
namespace {

MotionTraining small_training() {
  MotionTraining training;
  for (const auto& [feature, half_range] :
       std::vector<std::pair<const char*, double>>{{"forward@1", 0.005},
                                                   {"sideways@1", 0.005},
                                                   {"delta_theta@1", 0.05},
                                                   {"delta_theta@2", 0.05},
                                                   {"track_left", 0.3},
                                                   {"track_right", 0.3},
                                                   {"pitch", 0.3}}) {
    training.inputs.push_back({feature, 0.0, half_range, ""});
  }
  training.outputs = {{"forward", 0.0, 0.001, "forward@1"},
                      {"sideways", 0.0, 0.001, "sideways@1"},
                      {"delta_theta", 0.0, 0.01, "delta_theta@1"}};
  training.hidden = {8};
  training.window = 12;
  training.batch = 16;
  training.steps = 400;
  training.learning_rate = 0.01;
  return training;
}

/// A robot that lags behind its slipping tracks. One that turns left alone slips more the slower
/// it turns, which is another law for right turns to whoever has not seen any.
MotionSeries lagging_robot(std::uint64_t seed, bool only_left_turns = false) {
  WorldRandom random(seed, "lagging robot");
  MotionSeries series;
  series.soil = soil_preset("viper");
  const SkidKinematics slip{0.9, 0.2};
  FrameMotion motion;
  double left = 0.0;
  double right = 0.0;
  for (int frame = 0; frame < 2000; ++frame) {
    if (frame % 50 == 0) {
      left = random.uniform(-0.2, 0.2);
      right = random.uniform(-0.2, 0.2);
      if (only_left_turns && left > right) std::swap(left, right);
    }
    FrameMotion wanted = slip.motion(left, right);
    if (only_left_turns) wanted.turn_rad *= wanted.turn_rad / 0.02;
    motion.forward_m += 0.2 * (wanted.forward_m - motion.forward_m);
    motion.sideways_m = 0.0;
    motion.turn_rad += 0.2 * (wanted.turn_rad - motion.turn_rad);
    series.frames.push_back({motion, left, right, 0.1 * std::sin(frame * 0.01), 0.0, {}});
  }
  return series;
}

MotionTraining settling_training() {
  MotionTraining training = small_training();
  for (ModelChannel& output : training.outputs) {
    output.baseline = output.feature + "_settling";
    output.half_range *=
        1.0 - kSettlingLast - kSettlingBeforeLast;  // which the swing adds up to the whole
  }
  return training;
}

/// The same robot as a mirror shows it.
MotionSeries mirror_image(MotionSeries series) {
  for (MotionFrame& frame : series.frames) {
    frame.motion.sideways_m = -frame.motion.sideways_m;
    frame.motion.turn_rad = -frame.motion.turn_rad;
    frame.roll = -frame.roll;
    std::swap(frame.track_left_m_per_s, frame.track_right_m_per_s);
  }
  return series;
}

class GradientOf : public ::testing::TestWithParam<bool> {};

TEST_P(GradientOf, IsThatOfTheLoss) {
  const std::vector<MotionSeries> series = {lagging_robot(1), lagging_robot(2)};
  MotionTrainer trainer(GetParam() ? settling_training() : small_training());
  const std::vector<std::vector<float>> gradient = trainer.gradient(series);
  ASSERT_EQ(gradient.size(), 4U);
  constexpr float kStep = 0.004F;
  for (std::size_t array = 0; array < gradient.size(); ++array) {
    double greatest = 0.0;
    for (const float value : gradient[array]) {
      greatest = std::max(greatest, static_cast<double>(std::abs(value)));
    }
    for (std::size_t i = 0; i < gradient[array].size(); i += 3) {
      trainer.nudge(array, i, kStep);
      const double above = trainer.loss(series);
      trainer.nudge(array, i, -2.0F * kStep);
      const double below = trainer.loss(series);
      trainer.nudge(array, i, kStep);
      EXPECT_NEAR((above - below) / (2.0 * static_cast<double>(kStep)),
                  static_cast<double>(gradient[array][i]), 0.02 * greatest)
          << array << " " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(MotionTrainer, GradientOf, ::testing::Bool());

TEST(MotionTrainer, KnowsFromLeftTurnsWhatRightTurnsAreWhenItMirrors) {
  const MotionSeries left_turns = lagging_robot(6, true);
  MotionTraining training = small_training();
  training.steps = 200;
  const auto loss_on_right_turns = [&](bool mirror) {
    training.mirror = mirror;
    MotionTrainer trainer(training);
    for (std::size_t step = 0; step < training.steps; ++step) trainer.step({left_turns});
    return trainer.loss({mirror_image(left_turns)});
  };
  EXPECT_LT(loss_on_right_turns(true), 0.5 * loss_on_right_turns(false));
}

TEST(MotionTrainer, RefusesInputsAndBaselinesThatItCannotLearnWith) {
  for (const char* wrong : {"colour", "climb", "forward_settling"}) {
    MotionTraining training = small_training();
    training.inputs[0].feature = wrong;
    EXPECT_THROW(MotionTrainer{training}, InputError) << wrong;
  }
  MotionTraining training = small_training();
  training.outputs[0].baseline = "sideways_settling";
  EXPECT_THROW(MotionTrainer{training}, InputError);
}

TEST(MotionTrainer, LearnsALawAndTheSameSeedLearnsTheSame) {
  MotionConfiguration configuration;
  configuration.name = "lag";
  configuration.training = small_training();
  const std::vector<MotionSeries> series = {lagging_robot(1)};
  MotionTrainer trainer(configuration.training);
  MotionTrainer twin(configuration.training);
  for (std::size_t step = 0; step < configuration.training.steps; ++step) {
    const double loss = trainer.step(series);
    if (step < 20) {
      EXPECT_EQ(loss, twin.step(series));
    }
  }
  const std::vector<MotionSeries> other = {lagging_robot(3)};
  EXPECT_LT(trainer.loss(other), 0.02);
  const Model model = motion_model(configuration, trainer, series);
  const std::array<double, 3> r2 = one_frame_r2(model, other[0]);
  EXPECT_GT(r2[0], 0.995);
  EXPECT_GT(r2[2], 0.995);
}

}  // namespace
}  // namespace screed::nn
