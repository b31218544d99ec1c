// Counting over drives, and thresholds tried on them.
#include "nn/slip/slip_campaign.h"

#include <algorithm>
#include <cmath>

#include "hal/sample.h"
#include "nn/slip/gated_trainer.h"

namespace screed::nn {
namespace {

constexpr double kTrapped_s = 14.0;
constexpr std::size_t kHalfSecondTicks = kTickRate_hz / 2;

void add_drive(SlipFigures& figures, const SlipDrive& drive) {
  const TrueMotion motion(drive);
  std::vector<WatchTick> watch;
  replay(drive, [&](std::size_t i, const SlipWatch& it, const ReplayedTick& what) {
    watch.push_back({what.evaluated, it.stuck()});
    if (!what.concluded || !drive.ticks[i].running) return;
    const auto forward = motion.forward_share(i > kHalfSecondTicks ? i - kHalfSecondTicks : 0, i);
    const double said = it.travel_share() / 255.0;
    figures.share.add(said, forward.share, forward.belts_m);
    figures.share_by_ground[drive.ground].add(said, forward.share, forward.belts_m);
  });
  const StuckCounts counts = count_alarms(drive, motion, watch);
  figures.all += counts;
  figures.by_trap[drive.trap] += counts;
  figures.by_ground[drive.ground] += counts;
  if (counts.detected != 0) figures.delays_s.push_back(counts.delay_s);
  if (counts.dug_in > counts.detected) figures.missed.push_back(drive.seed);
  figures.failures += drive.failure.empty() ? 0 : 1;
}

}  // namespace

std::vector<StuckScenario> scenarios(const SlipCampaign& campaign) {
  std::vector<StuckScenario> all;
  const auto add_kind = [&](ScenarioKind kind, std::size_t count, double duration_s) {
    for (std::size_t i = 0; i < count; ++i)
      all.push_back(stuck_scenario(campaign.seed + i, kind, duration_s));
  };
  add_kind(ScenarioKind::kTrapped, campaign.trapped, kTrapped_s);
  add_kind(ScenarioKind::kFree, campaign.free, campaign.duration_s);
  add_kind(ScenarioKind::kOrdinary, campaign.ordinary, campaign.duration_s);
  return all;
}

std::vector<SlipDrive> run(const SlipCampaign& campaign, const TaskProgress& progress) {
  return drive_all(scenarios(campaign), campaign.threads, progress, campaign.folder);
}

void ShareError::add(double said, double truth, double weight_of_it) {
  const double error = said - truth;
  weight += weight_of_it;
  sum += weight_of_it * error;
  squares += weight_of_it * error * error;
  true_sum += weight_of_it * truth;
  true_squares += weight_of_it * truth * truth;
  missing_squares += weight_of_it * (1.0 - truth) * (1.0 - truth);
}

double ShareError::rms() const {
  return std::sqrt(squares / weight);
}

double ShareError::rms_of_one() const {
  return std::sqrt(missing_squares / weight);
}

double ShareError::rms_of_mean() const {
  return std::sqrt(std::max(0.0, true_squares / weight - true_mean() * true_mean()));
}

SlipFigures figures_of(const std::vector<SlipDrive>& drives) {
  SlipFigures figures;
  for (const SlipDrive& drive : drives) add_drive(figures, drive);
  return figures;
}

// ---- the threshold

namespace {

constexpr std::uint16_t kThresholdStep = 512;
constexpr std::uint16_t kMaxThreshold = 58000;  ///< odds of 480

/// A drive with the evidence of its steps.
struct Judged {
  const SlipDrive* drive;
  TrueMotion motion;
  std::vector<WatchTick> watch;  ///< evaluated alone
  std::vector<std::uint32_t> ticks;
  std::vector<std::uint16_t> evidence;
};

Judged judged(const SlipDrive& drive, GatedRunner& runner) {
  Judged result{&drive, TrueMotion(drive), {}, {}, {}};
  for (const WatchTick& tick : watch_of(drive)) result.watch.push_back({tick.evaluated, false});
  std::uint16_t evidence = 0;
  for (const SlipStep& step : slip_steps(drive, result.motion)) {
    if (step.forgets) {
      runner.forget();
      evidence = 0;
    }
    evidence = slip_evidence(evidence, runner.step(step.inputs)[0]);
    result.ticks.push_back(step.tick);
    result.evidence.push_back(evidence);
  }
  return result;
}

void set_stuck(Judged& drive, std::uint16_t threshold, std::uint16_t free) {
  bool stuck = false;
  std::size_t step = 0;
  for (std::size_t i = 0; i < drive.watch.size(); ++i) {
    if (step < drive.ticks.size() && drive.ticks[step] == i) {
      stuck = drive.evidence[step] >= threshold || (stuck && drive.evidence[step] >= free);
      ++step;
    }
    drive.watch[i].stuck = stuck && drive.watch[i].evaluated;
  }
}

}  // namespace

std::vector<ThresholdResult> try_thresholds(const SlipModel& model,
                                            const std::vector<SlipDrive>& drives) {
  GatedRunner runner(model.shape, model.parameters);
  std::vector<Judged> all;
  all.reserve(drives.size());
  for (const SlipDrive& drive : drives) all.push_back(judged(drive, runner));
  std::vector<ThresholdResult> results;
  for (std::uint16_t stuck = model.thresholds.slip; stuck <= kMaxThreshold;
       stuck = static_cast<std::uint16_t>(stuck + kThresholdStep)) {
    ThresholdResult result{stuck, {}};
    for (Judged& drive : all) {
      set_stuck(drive, stuck, model.thresholds.free);
      result.counts += count_alarms(*drive.drive, drive.motion, drive.watch);
    }
    results.push_back(result);
  }
  return results;
}

std::uint16_t choose_threshold(const std::vector<ThresholdResult>& results, double false_per_hour,
                               double early_per_drive) {
  std::uint16_t chosen = results.back().stuck;
  int detected = -1;
  for (auto result = results.rbegin(); result != results.rend(); ++result) {
    const StuckCounts& counts = result->counts;
    if (counts.false_alarms > false_per_hour * counts.driven_s / 3600.0 ||
        counts.early_alarms > early_per_drive * counts.trapped) {
      break;
    }
    if (counts.detected <= detected) continue;
    detected = counts.detected;
    chosen = result->stuck;
  }
  return chosen;
}

}  // namespace screed::nn
