// Counting over drives.
#include "nn/slip/slip_campaign.h"

#include <cmath>

#include "hal/sample.h"
#include "nn/slip/slip_replay.h"

namespace screed::nn {
namespace {

constexpr double kTrapped_s = 14.0;
constexpr std::size_t kAlarmShareWindow = kTickRate_hz / 2;

void add_drive(SlipFigures& figures, const SlipDrive& drive) {
  const TrueMotion motion(drive);
  std::vector<WatchTick> watch;
  replay(drive, [&](std::size_t i, const SlipWatch& it, const ReplayedTick& what) {
    watch.push_back({what.evaluated, it.stuck()});
    if (!what.concluded || !drive.ticks[i].running) return;
    const auto forward = motion.forward_share(i > kAlarmShareWindow ? i - kAlarmShareWindow : 0, i);
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

}  // namespace screed::nn
