// Drives and errors of the slip watch's figures.
#include "nn/slip/slip_campaign.h"

#include <gtest/gtest.h>

#include <cmath>

namespace screed::nn {
namespace {

TEST(SlipCampaign, ErrorsOfTheShareAreWeighted) {
  ShareError error;
  error.add(0.9, 1.0, 3.0);
  error.add(0.4, 0.2, 1.0);
  EXPECT_NEAR(error.true_mean(), 0.8, 1e-12);
  EXPECT_NEAR(error.mean(), (3.0 * -0.1 + 0.2) / 4.0, 1e-12);
  EXPECT_NEAR(error.rms(), std::sqrt((3.0 * 0.01 + 0.04) / 4.0), 1e-12);
  EXPECT_NEAR(error.rms_of_one(), std::sqrt(0.64 / 4.0), 1e-12);
  EXPECT_NEAR(error.rms_of_mean(), std::sqrt((3.0 * 0.04 + 0.36) / 4.0), 1e-12);
}

TEST(SlipCampaign, ScenariosFollowTheNumbersAndTheSeed) {
  SlipCampaign campaign;
  campaign.seed = 40;
  campaign.trapped = 2;
  campaign.ordinary = 1;
  campaign.duration_s = 30.0;
  const auto all = scenarios(campaign);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[1].kind, ScenarioKind::kTrapped);
  EXPECT_EQ(all[1].experiment.experiment.seed, 41U);
  EXPECT_EQ(all[2].kind, ScenarioKind::kOrdinary);
  EXPECT_EQ(all[2].experiment.experiment.seed, 40U);
  EXPECT_EQ(all[2].experiment.experiment.duration_s, 30.0);
}

}  // namespace
}  // namespace screed::nn
