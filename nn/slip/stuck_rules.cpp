// The true motion, alarms counted by it, the watch replayed, and labels.
#include "nn/slip/stuck_rules.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "hal/sample.h"
#include "host_sim/run/experiment/board_table.h"

namespace screed::nn {
namespace {

constexpr std::size_t kSecond = kTickRate_hz;
constexpr double kSmoothing = 1.0 / 8.0;
constexpr double kMinDrivenSpeed = 0.03;  ///< of tracks that count as driven, m/s
constexpr double kMinBelts_m = 1e-6;

double faster_track(const SlipTick& tick) {
  return static_cast<double>(std::max(std::abs(tick.track_left), std::abs(tick.track_right)));
}

double over(const std::vector<double>& sums, std::size_t begin, std::size_t end) {
  const std::size_t last = sums.size() - 1;
  return sums[std::min(end, last)] - sums[std::min(begin, last)];
}

}  // namespace

TrueMotion::TrueMotion(const SlipDrive& drive)
    : distance_{0.0}, turn_{0.0}, faster_track_{0.0}, belts_{0.0} {
  for (const SlipTick& tick : drive.ticks) {
    distance_.push_back(distance_.back() + static_cast<double>(tick.speed));
    turn_.push_back(turn_.back() + static_cast<double>(tick.turn));
    faster_track_.push_back(faster_track_.back() + faster_track(tick));
    belts_.push_back(belts_.back() + static_cast<double>(tick.track_left + tick.track_right) / 2.0);
  }
  dug_in_ = first_dug_in(drive);
}

double TrueMotion::travel_share(std::size_t begin, std::size_t end) const {
  const double of_track = over(faster_track_, begin, end);
  return of_track <= 0.0
             ? 1.0
             : (std::abs(over(distance_, begin, end)) + std::abs(over(turn_, begin, end))) /
                   of_track;
}

TrueMotion::ForwardShare TrueMotion::forward_share(std::size_t begin, std::size_t end) const {
  const double belts = over(belts_, begin, end) / kTickRate_hz;
  if (std::abs(belts) < kMinBelts_m) return {1.0, 0.0};
  return {std::clamp(over(distance_, begin, end) / kTickRate_hz / belts, 0.0, 1.0),
          std::abs(belts)};
}

std::optional<std::size_t> TrueMotion::first_dug_in(const SlipDrive& drive) const {
  double speed = 0.0;
  double turn = 0.0;
  double faster = 0.0;
  for (std::size_t i = 0; i + kSecond <= drive.ticks.size(); ++i) {
    const SlipTick& tick = drive.ticks[i];
    speed += (static_cast<double>(tick.speed) - speed) * kSmoothing;
    turn += (static_cast<double>(tick.turn) - turn) * kSmoothing;
    faster += (faster_track(tick) - faster) * kSmoothing;
    if (!tick.running || faster_track(tick) < kMinDrivenSpeed) continue;
    if (std::abs(speed) + std::abs(turn) > (kDugInShare + 0.05) * faster) continue;
    if (travel_share(i, i + kSecond) < kDugInShare) return i;
  }
  return std::nullopt;
}

namespace {

enum class Alarm : std::uint8_t { kFalse, kRecovered, kTrue };

/// What an alarm is that begins at that tick of a robot that is not dug in.
Alarm alarm_at(const TrueMotion& motion, std::size_t tick) {
  const std::size_t begin = tick > kSecond / 2 ? tick - kSecond / 2 : 0;
  if (motion.travel_share(begin, tick + 1) > kFreeShare) return Alarm::kFalse;
  return motion.travel_share(begin, tick + kSecond / 2) > kFreeShare ? Alarm::kRecovered
                                                                     : Alarm::kTrue;
}

bool rises(const std::vector<WatchTick>& watch, std::size_t i) {
  return watch[i].stuck && (i == 0 || !watch[i - 1].stuck);
}

void count_trapped(const TrueMotion& motion, const std::vector<WatchTick>& watch,
                   StuckCounts& counts) {
  const auto dug_in = motion.dug_in_at();
  const std::size_t begin = dug_in.value_or(watch.size());
  counts.trapped = 1;
  counts.dug_in = dug_in ? 1 : 0;
  bool too_early = false;  // the alarm that is on
  for (std::size_t i = 0; i < watch.size() && i <= begin + kSecond; ++i) {
    if (rises(watch, i)) {
      const bool early = i < begin && alarm_at(motion, i) == Alarm::kFalse;
      counts.early_alarms += early ? 1 : 0;
      too_early = early && i + kSecond < begin;
    }
    if (i < begin || !watch[i].stuck || too_early || counts.detected != 0) continue;
    counts.detected = 1;
    counts.delay_s = static_cast<double>(i - begin) / kTickRate_hz;
  }
}

void count_free(const TrueMotion& motion, const std::vector<WatchTick>& watch,
                StuckCounts& counts) {
  for (std::size_t i = 0; i < watch.size(); ++i) {
    if (watch[i].evaluated) counts.driven_s += 1.0 / kTickRate_hz;
    if (!rises(watch, i)) continue;
    const Alarm alarm = alarm_at(motion, i);
    counts.false_alarms += alarm == Alarm::kFalse ? 1 : 0;
    counts.recovered_alarms += alarm == Alarm::kRecovered ? 1 : 0;
    counts.other_alarms += alarm == Alarm::kTrue ? 1 : 0;
  }
}

}  // namespace

StuckCounts& StuckCounts::operator+=(const StuckCounts& other) {
  trapped += other.trapped;
  dug_in += other.dug_in;
  detected += other.detected;
  early_alarms += other.early_alarms;
  driven_s += other.driven_s;
  false_alarms += other.false_alarms;
  recovered_alarms += other.recovered_alarms;
  other_alarms += other.other_alarms;
  return *this;
}

StuckCounts count_alarms(const SlipDrive& drive, const TrueMotion& motion,
                         const std::vector<WatchTick>& watch) {
  StuckCounts counts;
  if (drive.kind == ScenarioKind::kTrapped) {
    count_trapped(motion, watch, counts);
  } else {
    count_free(motion, watch, counts);
  }
  return counts;
}

void replay(const SlipDrive& drive,
            const std::function<void(std::size_t tick, const SlipWatch& watch,
                                     const ReplayedTick& what)>& on_tick) {
  SlipWatch watch(board_constants_of(kDefaultBoard).tread_mm);
  bool forgets = true;
  for (std::size_t i = 0; i < drive.ticks.size(); ++i) {
    const SlipTick& tick = drive.ticks[i];
    const bool half_done = watch.half_done();
    // Packets leave in every second tick.
    watch.tick({tick.speed_left, tick.effort_left}, {tick.speed_right, tick.effort_right},
               tick.gyro.data(), tick.accel.data(), tick.sin_pitch_q14, tick.yaw_rate, i % 2 == 0);
    const int faster = std::max(std::abs(int{tick.speed_left}), std::abs(int{tick.speed_right}));
    const bool fast = faster >= SlipWatch::kMinTrackSpeed_dmm_per_s;
    forgets = forgets || faster < SlipWatch::kStanding_dmm_per_s;
    const ReplayedTick what = {tick.running && fast, half_done && !watch.half_done() && fast,
                               forgets};
    on_tick(i, watch, what);
    if (what.concluded) forgets = false;
  }
}

std::vector<WatchTick> watch_of(const SlipDrive& drive) {
  std::vector<WatchTick> ticks;
  ticks.reserve(drive.ticks.size());
  replay(drive, [&](std::size_t /*tick*/, const SlipWatch& watch, const ReplayedTick& what) {
    ticks.push_back({what.evaluated, watch.stuck()});
  });
  return ticks;
}

// ---- steps of the network, with labels

namespace {

constexpr std::size_t kMotionWindow = 15;  // ticks before and after, over which motion is taken
constexpr double kHeldMax = 0.25;
constexpr double kFreeMin = 0.4;
constexpr std::size_t kShareWindow = kTickRate_hz / 2;

}  // namespace

std::vector<SlipStep> slip_steps(const SlipDrive& drive, const TrueMotion& motion) {
  std::vector<SlipStep> steps;
  replay(drive, [&](std::size_t i, const SlipWatch& watch, const ReplayedTick& what) {
    if (!what.concluded) return;
    const SlipTick& tick = drive.ticks[i];
    SlipStep step{};
    std::copy_n(watch.network_inputs(), kSlipInputs, step.inputs.begin());
    step.tick = static_cast<std::uint32_t>(i);
    step.forgets = what.forgets;
    if (tick.running) {
      const double share =
          motion.travel_share(i > kMotionWindow ? i - kMotionWindow : 0, i + kMotionWindow);
      const double before = motion.travel_share(i > kShareWindow ? i - kShareWindow : 0, i + 1);
      const bool free = share > kFreeMin || before > kFreeShare;
      step.held = !free && share < kHeldMax ? 1.0F : 0.0F;
      step.held_weight = free || share < kHeldMax ? 1.0F : 0.0F;
      const auto forward = motion.forward_share(i > kShareWindow ? i - kShareWindow : 0, i);
      step.share = static_cast<float>(forward.share);
      step.share_weight =
          static_cast<float>(forward.belts_m * kTickRate_hz / static_cast<double>(kShareWindow));
    }
    steps.push_back(step);
  });
  return steps;
}

}  // namespace screed::nn
