// Options of the commands that drive for the slip watch.
#pragma once

#include <memory>

#include "nn/slip/slip_campaign.h"
#include "tools/screed/cli/command.h"

namespace screed {

struct SlipCampaignArguments {
  nn::SlipCampaign campaign;
  bool quiet = false;
};

void add_campaign_options(Command& command, SlipCampaignArguments& arguments);

/// The drives, with a bar of progress.
std::vector<nn::SlipDrive> run_campaign(const SlipCampaignArguments& arguments);

}  // namespace screed
