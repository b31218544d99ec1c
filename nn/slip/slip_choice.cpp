#include "nn/slip/slip_choice.h"

#include "nn/slip/gated_network.h"
#include "nn/slip/slip_campaign.h"
#include "nn/slip/slip_replay.h"
#include "nn/slip/slip_sequence.h"

namespace screed::nn {
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
