// What a worker says of a trial, and what follows from it.
#include "host_sim/campaign/campaign_run.h"

#include <gtest/gtest.h>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

TEST(CampaignWorker, CostsAreReadBack) {
  const RunCost read = parse_cost(cost_text({0.5, 0.25, 2.0}));
  EXPECT_EQ(read.setup_s, 0.5);
  EXPECT_EQ(read.per_second_s, 0.25);
  EXPECT_EQ(read.finish_s, 2.0);
  for (const char* text : {"", "hello", "{}"}) EXPECT_THROW(parse_cost(text), RunError) << text;
}

TEST(CampaignTrial, TellsTimeAndLimit) {
  CampaignTrial trial;
  trial.costs = {{1.0, 0.5, 1.0}, {3.0, 1.5, 1.0}};
  EXPECT_DOUBLE_EQ(trial.mean_s(10.0), (7.0 + 19.0) / 2.0);
  EXPECT_DOUBLE_EQ(trial.greatest_s(10.0), 19.0);
  CampaignPlan plan;
  plan.cells.resize(1);
  plan.durations_s = {10.0};
  EXPECT_DOUBLE_EQ(time_limit_s(plan, 0, trial), 60.0 + 10.0 * 19.0);
  plan.settings.time_limit_s = 5.0;
  EXPECT_DOUBLE_EQ(time_limit_s(plan, 0, trial), 5.0);
}

}  // namespace
}  // namespace screed
