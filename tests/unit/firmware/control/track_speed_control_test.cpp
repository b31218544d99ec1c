// Speed observer and speed loop of one track.
#include "firmware/control/track_speed_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "boards/a_star_32u4/board.h"
#include "hal/sample.h"
#include "tests/unit/firmware/control/simulated_track.h"

namespace screed {
namespace {

constexpr double kDmmPerCount = 9048.0 / 16.0;  // 0.1 mm/s for one count a tick
constexpr uint16_t kNominal_mv = 7200;

TrackSpeedControl make_control(const Parameters& parameters = {}) {
  return TrackSpeedControl(kBoard, parameters);
}

TEST(SpeedObserver, SettlesOnTheSpeedOfASteadyRamp) {
  for (const int16_t counts :
       std::initializer_list<int16_t>{-40, -17, -4, -1, 0, 1, 2, 4, 25, 40}) {
    TrackSpeedControl control = make_control();
    for (int tick = 0; tick < 200; ++tick) control.release(counts);
    EXPECT_NEAR(control.speed_dmm_per_s(), counts * kDmmPerCount, 2.0) << counts;
  }
}

TEST(SpeedObserver, FractionsOfACountATickAreAveraged) {
  // 1.8 counts a tick, as at 0.1 m/s: four of five ticks give 2, one gives 1.
  TrackSpeedControl control = make_control();
  double lowest = 1e9;
  double highest = -1e9;
  for (int tick = 0; tick < 400; ++tick) {
    control.release(tick % 5 == 4 ? 1 : 2);
    if (tick < 200) continue;
    lowest = std::min(lowest, static_cast<double>(control.speed_dmm_per_s()));
    highest = std::max(highest, static_cast<double>(control.speed_dmm_per_s()));
  }
  EXPECT_GT(lowest, 0.95 * 1.8 * kDmmPerCount);
  EXPECT_LT(highest, 1.05 * 1.8 * kDmmPerCount);
}

TEST(SpeedObserver, StepResponseIsThatOfADoublePole) {
  // Transfer function of an alpha-beta filter from position to speed with both poles at r: (1-r)^2
  // z (z-1) / (z-r)^2. A speed that begins in tick 0 is the position z^2 / (z-1)^2; its answer is 1
  // - (k+2) r^(k+1) + (k+1) r^(k+2).
  const double r = 0.837;
  TrackSpeedControl control = make_control();
  const double final = 20 * kDmmPerCount;
  for (int k = 0; k < 60; ++k) {
    control.release(20);
    const double expected =
        final * (1.0 - (k + 2) * std::pow(r, k + 1) + (k + 1) * std::pow(r, k + 2));
    EXPECT_NEAR(control.speed_dmm_per_s(), expected, 0.006 * final) << k;
  }
}

TEST(SpeedObserver, StopsAtItsRange) {
  TrackSpeedControl control = make_control();
  for (int tick = 0; tick < 300; ++tick) control.release(kMaxTrackCounts);
  EXPECT_EQ(control.speed_dmm_per_s(), INT16_MAX);  // 100 counts a tick are 5.7 m/s
  for (int tick = 0; tick < 300; ++tick) control.release(-kMaxTrackCounts);
  EXPECT_EQ(control.speed_dmm_per_s(), INT16_MIN);
}

TEST(SpeedObserver, SettlesOnEverySpeedThatABoardsTrackReaches) {
  // The Zumo 32U4: 796 mm/s at full duty are 61 counts a tick.
  const BoardConstants zumo = {2100, 1221, 85, 6000, 796, 59};
  for (const double speed_mm_per_s : {-796.0, -700.0, 525.0, 700.0, 796.0}) {
    TrackSpeedControl control(zumo, {});
    const double counts_a_tick = speed_mm_per_s * 160.0 / zumo.count_um_q4;
    for (int tick = 0; tick < 400; ++tick) {
      control.release(static_cast<int16_t>(std::floor((tick + 1) * counts_a_tick) -
                                           std::floor(tick * counts_a_tick)));
    }
    EXPECT_NEAR(control.speed_dmm_per_s(), 10.0 * speed_mm_per_s, 50.0);
  }
}

TEST(TrackSpeedControl, ReachesTheTargetWithoutErrorAgainstALoad) {
  for (const int16_t target : std::initializer_list<int16_t>{-200, -60, 20, 100, 200}) {
    TrackSpeedControl control = make_control();
    SimulatedTrack track;
    int16_t counts = 0;
    double highest = 0.0;
    double sum = 0.0;
    for (int tick = 0; tick < 500; ++tick) {
      // 600 mm/s^2, as DriveControl lets a target rise.
      const auto ramp = static_cast<int16_t>(std::clamp<int>(target, -6 * tick, 6 * tick));
      counts = track.step(control.tick(ramp, counts, kNominal_mv), 7.2, 30.0);
      highest = std::max(highest, std::abs(track.speed_mm_per_s));
      if (tick >= 300) sum += track.speed_mm_per_s;
    }
    EXPECT_NEAR(sum / 200.0, target, 1.0);
    EXPECT_LT(highest, std::abs(target) * 1.25 + 10.0);
  }
}

TEST(TrackSpeedControl, FeedForwardMakesUpForTheBattery) {
  // Without the controller's help the same target gives the same speed at any voltage.
  Parameters open_loop;
  open_loop.speed_kp() = 0;
  open_loop.speed_ki() = 0;
  for (const double battery_v : {6.0, 7.2, 8.1}) {
    TrackSpeedControl control = make_control(open_loop);
    SimulatedTrack track;
    for (int tick = 0; tick < 100; ++tick) {
      track.step(control.tick(150, 0, static_cast<uint16_t>(battery_v * 1000)), battery_v);
    }
    EXPECT_NEAR(track.speed_mm_per_s, 150.0, 0.025 * 150.0) << battery_v;
  }
  // A reading that cannot be a battery's does not ask for more than twice the nominal duty.
  TrackSpeedControl control = make_control(open_loop);
  EXPECT_NEAR(control.tick(50, 0, 0), 160, 2);
}

TEST(TrackSpeedControl, DoesNotWindUpWhileItsDutyIsAtTheLimit) {
  // A track held for 5 s, then freed: it comes back from the limit within the time the observer
  // needs, not after 5 s.
  TrackSpeedControl control = make_control();
  SimulatedTrack track;
  for (int tick = 0; tick < 500; ++tick) control.tick(100, 0, kNominal_mv);
  int16_t counts = 0;
  double highest = 0.0;
  int last_above = 0;
  for (int tick = 0; tick < 300; ++tick) {
    counts = track.step(control.tick(100, counts, kNominal_mv));
    highest = std::max(highest, track.speed_mm_per_s);
    if (track.speed_mm_per_s > 110.0) last_above = tick;
  }
  EXPECT_LT(last_above, 60);
  EXPECT_NEAR(track.speed_mm_per_s, 100.0, 6.0);
  EXPECT_LE(highest, 250.0);
}

TEST(TrackSpeedControl, AtRestTheDutyIsNone) {
  TrackSpeedControl control = make_control();
  SimulatedTrack track;
  int16_t counts = 0;
  for (int tick = 0; tick < 200; ++tick)
    counts = track.step(control.tick(150, counts, kNominal_mv));
  int16_t duty = 0;
  for (int tick = 0; tick < 100; ++tick) {
    duty = control.tick(0, counts, kNominal_mv);
    counts = track.step(duty);
  }
  EXPECT_EQ(duty, 0);
  EXPECT_NEAR(track.speed_mm_per_s, 0.0, 1.0);
}

TEST(TrackSpeedControl, ReleaseForgetsTheIntegral) {
  TrackSpeedControl held = make_control();
  for (int tick = 0; tick < 100; ++tick) held.tick(100, 0, kNominal_mv);
  held.release(0);
  TrackSpeedControl fresh = make_control();
  EXPECT_EQ(held.tick(100, 0, kNominal_mv), fresh.tick(100, 0, kNominal_mv));
}

TEST(TrackSpeedControl, EveryParameterAtItsEndsStaysWithinTheDutyRange) {
  Parameters strongest;
  strongest.speed_kp() = 320;
  strongest.speed_ki() = 3200;
  for (const int16_t target : std::initializer_list<int16_t>{INT16_MIN, INT16_MAX}) {
    for (const int16_t counts : std::initializer_list<int16_t>{INT16_MIN, INT16_MAX}) {
      for (const uint16_t battery_mv : std::initializer_list<uint16_t>{0, 3599, 3600, 65535}) {
        TrackSpeedControl control = make_control(strongest);
        for (int tick = 0; tick < 50; ++tick) {
          const int16_t duty = control.tick(target, counts, battery_mv);
          ASSERT_LE(std::abs(duty), kDutyMax);
        }
      }
    }
  }
}

/// The control law of track_speed_control.h in floating point.
class LawInNumbers {
 public:
  LawInNumbers(double kp, double ki) : kp_(kp / 16.0), ki_(ki / 16.0) {}

  double tick(double target_mm_per_s, double counts, double battery_mv) {
    constexpr double kPole = 0.837;
    const double filter_error = lag_ + std::clamp(counts, -40.0, 40.0) - speed_;
    lag_ = filter_error * kPole * kPole;
    speed_ += (1.0 - kPole) * (1.0 - kPole) * filter_error;
    halfway_ += (target_mm_per_s - halfway_) * 42.0 / 256.0;
    expected_ += (halfway_ - expected_) * 42.0 / 256.0;
    const double speed_mm_per_s = speed_ * kDmmPerCount / 10.0;
    effort = 0.0;
    if (target_mm_per_s == 0.0 && std::abs(speed_mm_per_s) < 10.0) {
      integral_ = 0.0;
      return 0.0;
    }
    const double error = std::clamp(expected_ - speed_mm_per_s, -300.0, 300.0);
    const double feed_forward = target_mm_per_s * kDutyMax / kBoard.full_speed_mm_per_s *
                                kNominal_mv / std::max(battery_mv, kNominal_mv / 2.0);
    const double without_integral = feed_forward + kp_ * error;
    const double unlimited = without_integral + integral_;
    const bool pushes_out = std::abs(unlimited) >= kDutyMax && unlimited * error > 0.0;
    if (!pushes_out) {
      integral_ = std::clamp(integral_ + ki_ * error / 100.0, -1.0 * kDutyMax, 1.0 * kDutyMax);
    }
    const double duty = std::clamp(without_integral + integral_, -1.0 * kDutyMax, 1.0 * kDutyMax);
    effort = duty - feed_forward;
    return duty;
  }

  double effort = 0.0;  ///< duty beyond what drives the unloaded track

 private:
  double kp_;
  double ki_;
  double lag_ = 0.0;
  double speed_ = 0.0;
  double halfway_ = 0.0;
  double expected_ = 0.0;
  double integral_ = 0.0;
};

TEST(TrackSpeedControl, FollowsItsLawInNumbers) {
  struct Part {
    int16_t target;
    int16_t counts;  ///< a tick, twice as many in every second one and none in the others
    uint16_t battery_mv;
    int ticks;
  };
  // Follows, lags, is blocked, is pushed, overtakes, stands; either way and with any battery.
  const Part parts[] = {{0, 0, 7200, 20},     {200, 4, 7200, 120},   {200, 3, 6400, 60},
                        {-150, -3, 8000, 90}, {-150, 0, 7200, 40},   {120, 1, 7200, 80},
                        {120, 4, 3000, 50},   {-60, -2, 3601, 60},   {0, 0, 7200, 60},
                        {250, 20, 7200, 60},  {-250, -20, 7200, 60}, {30, 0, 7200, 200},
                        {-30, 0, 7200, 200},  {1, 0, 7200, 50},      {0, 0, 7200, 50}};
  for (const auto& [kp, ki] : {std::pair{24, 160}, {0, 400}, {60, 40}, {6, 2400}}) {
    Parameters parameters;
    parameters.speed_kp() = static_cast<int16_t>(kp);
    parameters.speed_ki() = static_cast<int16_t>(ki);
    TrackSpeedControl control = make_control(parameters);
    LawInNumbers law(kp, ki);
    const double tolerance = 9.0 + 0.15 * kp;  // gains of the filters are whole 256ths
    for (const Part& part : parts) {
      for (int tick = 0; tick < part.ticks; ++tick) {
        const auto counts = static_cast<int16_t>(tick % 2 == 0 ? 2 * part.counts : 0);
        const double expected = law.tick(part.target, counts, part.battery_mv);
        ASSERT_NEAR(control.tick(part.target, counts, part.battery_mv), expected, tolerance)
            << "gains " << kp << " " << ki << ", target " << part.target << ", tick " << tick;
        ASSERT_NEAR(control.motion().effort, law.effort, tolerance)
            << part.target << ", tick " << tick;
      }
    }
  }
}

TEST(TrackSpeedControl, ReleasedItAsksForNoEffort) {
  TrackSpeedControl control = make_control();
  for (int tick = 0; tick < 50; ++tick) control.tick(200, 1, kNominal_mv);
  ASSERT_GT(control.motion().effort, 20);
  control.release(0);
  EXPECT_EQ(control.motion().effort, 0);
}

}  // namespace
}  // namespace screed
