// The slip watch's network learns from drives which ticks are those of a robot that hardly moves.
#include "nn/slip/slip_training.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "host_sim/core/errors.h"

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
