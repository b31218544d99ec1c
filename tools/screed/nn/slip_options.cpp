#include "tools/screed/nn/slip_options.h"

#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {

void add_campaign_options(Command& command, SlipCampaignArguments& arguments) {
  nn::SlipCampaign& campaign = arguments.campaign;
  constexpr NumberRange kDrives{0, 100000};
  add_number(command, "--seed", campaign.seed,
             "Seed of the first drive of each kind; each further drive adds 1", kSeedRange);
  add_number(command, "--trapped", campaign.trapped, "Number of drives into a trap (14 s)",
             kDrives);
  add_number(command, "--free", campaign.free, "Number of drives without a trap, slopes to 8 deg",
             kDrives);
  add_number(command, "--ordinary", campaign.ordinary,
             "Number of drives of leveling algorithms, slopes to 20 deg, or in beds with walls",
             kDrives);
  add_number(command, "--duration", campaign.duration_s, "Duration of a drive without a trap [s]",
             {5.0, 36000.0});
  add_number(command, "--threads", campaign.threads, "Number of drives run in parallel", {1, 256});
  command
      .add_option("--drives", campaign.folder,
                  "Folder to keep drives in; those that are there are not driven again")
      ->type_name("DIR");
  command.add_flag("--quiet", arguments.quiet, "Show no progress");
}

std::vector<nn::SlipDrive> run_campaign(const SlipCampaignArguments& arguments) {
  TaskBar bar(arguments.quiet, "");
  return nn::run(arguments.campaign, bar.progress());
}

}  // namespace screed
