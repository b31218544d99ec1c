// What the slip watch's network sees, against the same quantities in floating point: rounded where
// the firmware rounds, without its widths, its saturation only where the header promises one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "firmware/estimation/slip_model.h"
#include "firmware/estimation/slip_watch.h"
#include "nn/infer/gated.h"

namespace screed {
namespace {

constexpr uint16_t kTread_mm = 195;
constexpr double kUnit = 128.0;  // Q7

double limited(double value, double limit) {
  return std::clamp(value, -limit, limit);
}

struct Tick {
  TrackMotion left{}, right{};
  std::array<int16_t, 3> gyro{}, accel{};
  int16_t sin_pitch_q14 = 0;
  int32_t yaw_rate = 0;
};

/// Mean of an axis over 64 ticks and mean magnitude over 16.
struct ReferenceVibration {
  double sum = 0.0;        // 64 times the mean
  double band_pass = 0.0;  // a decay of 3/4 a tick
  double magnitude = 0.0;  // 16 times the mean

  void add(double counts) {
    const double residual = counts - std::floor(sum / 64.0);
    sum += residual;
    band_pass += limited(residual, 250.0) - std::floor(band_pass / 4.0);
    magnitude += std::abs(band_pass) - std::floor(magnitude / 16.0);
  }
};

struct ReferenceWatch {
  double belts = 0.0;            // 0.2 mm/s
  double bias = 0.0;             // 512 times, of a tick's gain
  std::array<double, 3> lost{};  // two counts over a tick: 0.048 mm/s
  std::array<double, 3> forget{64.0, 256.0, 1024.0};
  double yaw_rate = 0.0;  // a quarter of an angle unit a second
  double effort = 0.0;    // 8 times
  std::array<ReferenceVibration, 3> vibration{};
  double faster = 0.0;  // 0.1 mm/s

  void add(const Tick& tick) {
    const double left = std::floor(tick.left.speed_dmm_per_s / 2.0);
    const double right = std::floor(tick.right.speed_dmm_per_s / 2.0);
    faster = 2.0 * std::max(std::abs(left), std::abs(right));
    const double now = std::floor((left + right) / 2.0);
    const double change = now - belts;
    belts = now;
    // Gravity's share of the accelerometer is the sine of the pitch: 4096 counts, 2048 units of
    // two.
    const double gained = 4.0 * change + std::floor(change / 4.0) -
                          std::floor(tick.accel[0] / 2.0) + std::floor(tick.sin_pitch_q14 / 8.0) -
                          std::floor(std::floor(bias / 256.0) / 2.0);
    const bool stands = faster < 100.0;
    bias += stands ? 8.0 * gained : gained;
    for (int i = 0; i < 3; ++i) {
      lost[i] = stands ? 0.0 : lost[i] + gained - std::floor(lost[i] / forget[i]);
    }
    vibration[0].add(tick.gyro[1]);
    vibration[1].add(tick.accel[0]);
    vibration[2].add(tick.accel[2]);
    yaw_rate += std::floor((std::floor(tick.yaw_rate / 4.0) - yaw_rate) / 16.0);
    effort += (left < 0.0 ? -1.0 : 1.0) * tick.left.effort +
              (right < 0.0 ? -1.0 : 1.0) * tick.right.effort - std::floor(effort / 8.0);
  }

  std::array<double, kSlipInputs> inputs(const Tick& tick) const {
    const double ahead = belts < 0.0 ? -1.0 : 1.0;
    const double difference =
        std::floor(tick.right.speed_dmm_per_s / 2.0) - std::floor(tick.left.speed_dmm_per_s / 2.0);
    // A robot of this tread that turns by w has w * tread / 2 at its tracks.
    const double rad_per_s = 4.0 * std::abs(yaw_rate) * 2.0 * 3.14159265358979 / 65536.0;
    const double turn_dmm_per_s = rad_per_s * kTread_mm / 2.0 * 10.0;
    const auto logarithm = [](double magnitude) {
      return magnitude < 64.0 ? -128.0 : 32.0 * (std::log2(magnitude) - 10.0);
    };
    std::array<double, kSlipInputs> inputs = {
        ahead * kUnit * lost[0] / 2.0 / faster, ahead * kUnit * lost[1] / 2.0 / faster,
        ahead * kUnit * lost[2] / 2.0 / faster, kUnit * turn_dmm_per_s / faster,
        kUnit * std::abs(difference) / faster,  faster / 32.0,
        ahead * tick.sin_pitch_q14 / 64.0,      effort / 8.0,
        logarithm(vibration[0].magnitude),      logarithm(vibration[1].magnitude),
        logarithm(vibration[2].magnitude),      ahead * vibration[0].sum / 64.0,
    };
    for (double& input : inputs) input = limited(input, 127.0);
    return inputs;
  }
};

/// Drives on for a while, turns, stands, goes back; bumps that shake more than the limit.
class RandomDrive {
 public:
  explicit RandomDrive(unsigned seed) : random_(seed) {}

  Tick next() {
    if (left_ticks_-- == 0) {
      left_ticks_ = 20 + static_cast<int>(random_() % 300U);
      const auto kind = random_() % 4U;
      target_ = kind == 0 ? 0.0 : between(-2500.0, 2500.0);
      turn_ = kind == 1 ? between(-1500.0, 1500.0) : 0.0;
      slip_ = between(0.0, 1.0);
      shaking_ = kind == 2 ? 400.0 : 30.0;
      pitch_rate_ = between(-40.0, 40.0);
    }
    const double change = limited(target_ - speed_, 60.0);
    speed_ += change;
    turning_ += limited(turn_ - turning_, 60.0);
    pitch_ = limited(pitch_ + pitch_rate_ * 0.2, 6000.0);
    Tick tick;
    tick.left = {whole(speed_ - turning_), whole(between(-20.0, 300.0))};
    tick.right = {whole(speed_ + turning_), whole(between(-20.0, 300.0))};
    tick.gyro = {whole(between(-50.0, 50.0)), whole(pitch_rate_ + between(-shaking_, shaking_)), 0};
    tick.accel = {
        whole((1.0 - slip_) * change * 4.18 + pitch_ / 4.0 + between(-shaking_, shaking_)), 0,
        whole(4098.0 + between(-shaking_, shaking_))};
    tick.sin_pitch_q14 = whole(pitch_);
    // 0.1 mm/s at the tracks to units: 2 / tread, 65536 / 2 pi.
    tick.yaw_rate = static_cast<int32_t>((1.0 - slip_) * turning_ * 10.0);
    return tick;
  }

 private:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  static int16_t whole(double value) {
    return static_cast<int16_t>(std::lround(limited(value, 32767.0)));
  }

  std::mt19937 random_;
  int left_ticks_ = 0;
  double target_ = 0.0, turn_ = 0.0, speed_ = 0.0, turning_ = 0.0;
  double slip_ = 0.0, shaking_ = 0.0, pitch_rate_ = 0.0, pitch_ = 0.0;
};

TEST(SlipWatchInputs, AreTheFormulasInFloatingPoint) {
  std::array<int, kSlipInputs> seen{};  // inputs that were neither nothing nor at their limit
  for (unsigned seed = 1; seed <= 8; ++seed) {
    RandomDrive drive(seed);
    SlipWatch watch(kTread_mm);
    ReferenceWatch reference;
    for (int i = 0; i < 6000; ++i) {
      const Tick tick = drive.next();
      reference.add(tick);
      watch.tick(tick.left, tick.right, tick.gyro.data(), tick.accel.data(), tick.sin_pitch_q14,
                 tick.yaw_rate, true);
      if (reference.faster >= SlipWatch::kMinTrackSpeed_dmm_per_s && !watch.half_done()) continue;
      if (reference.faster < SlipWatch::kMinTrackSpeed_dmm_per_s) {
        ASSERT_EQ(watch.evidence(), 0) << i;
        continue;
      }
      const auto expected = reference.inputs(tick);
      for (int input = 0; input < kSlipInputs; ++input) {
        // A unit for the rounding, one for that of what it is made of, the lines between the powers
        // of two; 126 stands for 125.66 in the turn.
        const double tolerance =
            (input >= 8 && input <= 10 ? 4.0 : 2.0) + std::abs(expected[input]) * 0.004;
        ASSERT_NEAR(watch.network_inputs()[input], expected[input], tolerance)
            << "input " << input << ", tick " << i << ", seed " << seed;
        if (std::abs(expected[input]) > 3.0 && std::abs(expected[input]) < 127.0) ++seen[input];
      }
    }
  }
  for (int input = 0; input < kSlipInputs; ++input) EXPECT_GT(seen[input], 1500) << input;
}

TEST(SlipWatchInputs, SlipsIsStuckAndIsFreeAgainFromTheModelsThresholds) {
  using nn::model_slip::kFreeEvidence;
  using nn::model_slip::kSlipEvidence;
  using nn::model_slip::kStuckEvidence;
  int rising = 0;
  int falling = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    RandomDrive drive(seed);
    SlipWatch watch(kTread_mm);
    bool was_stuck = false;
    for (int i = 0; i < 3000; ++i) {
      const Tick tick = drive.next();
      watch.tick(tick.left, tick.right, tick.gyro.data(), tick.accel.data(), tick.sin_pitch_q14,
                 tick.yaw_rate, i % 2 == 0);
      const uint16_t evidence = watch.evidence();
      ASSERT_EQ(watch.slips(), evidence >= kSlipEvidence) << evidence;
      const bool between = evidence >= kFreeEvidence && evidence < kStuckEvidence;
      ASSERT_EQ(watch.stuck(), between ? was_stuck : evidence >= kStuckEvidence) << evidence;
      rising += between && !was_stuck ? 1 : 0;
      falling += between && was_stuck ? 1 : 0;
      was_stuck = watch.stuck();
    }
  }
  EXPECT_GT(rising, 0) << "the band below the threshold was seen";
  EXPECT_GT(falling, 0);
}

TEST(SlipWatchInputs, EvidenceAndShareAreThoseOfTheNetworksAnswers) {
  constexpr nn::GatedShape kShape = {kSlipInputs, kSlipUnits, kSlipOutputs};
  RandomDrive drive(5);
  SlipWatch watch(kTread_mm);
  std::array<int8_t, kShape.values()> values{};
  std::array<int16_t, kSlipUnits> candidates{}, states{};
  std::array<int16_t, kSlipOutputs> outputs{};
  double evidence = 0.0;
  int asked = 0;
  int none = 0;
  int all = 0;
  for (int i = 0; i < 20000; ++i) {
    const Tick tick = drive.next();
    const bool half_done = watch.half_done();
    watch.tick(tick.left, tick.right, tick.gyro.data(), tick.accel.data(), tick.sin_pitch_q14,
               tick.yaw_rate, i % 2 == 0);
    const int faster = std::max(std::abs(int{tick.left.speed_dmm_per_s}),
                                std::abs(int{tick.right.speed_dmm_per_s}));
    if (faster < SlipWatch::kStanding_dmm_per_s) {
      states.fill(0);
      std::fill(values.begin() + kSlipInputs, values.end(), int8_t{0});
    }
    if (i % 2 == 0 && faster < SlipWatch::kMinTrackSpeed_dmm_per_s) {
      evidence = 0.0;
      ASSERT_EQ(watch.travel_share(), 255) << "nothing is known";
    } else if (i % 2 == 0 && !half_done) {
      std::copy_n(watch.network_inputs(), kSlipInputs, values.begin());
      nn::gated_candidates(kShape, nn::model_slip::parameters, values.data(), candidates.data());
    } else if (i % 2 == 0) {
      nn::gated_update(kShape, nn::model_slip::parameters, values.data(), candidates.data(),
                       states.data(), outputs.data());
      evidence += ((outputs[0] + 32768.0) - evidence) / 4.0;
      ASSERT_EQ(watch.travel_share(), std::clamp(std::floor(outputs[1] / 16.0), 0.0, 255.0)) << i;
      none += watch.travel_share() == 0 ? 1 : 0;
      all += watch.travel_share() == 255 ? 1 : 0;
      ++asked;
    }
    ASSERT_NEAR(watch.evidence(), evidence, 16.0) << i;
  }
  EXPECT_GT(asked, 3000);
  EXPECT_GT(none, 0);
  EXPECT_GT(all, 0);
}

}  // namespace
}  // namespace screed
