// Texts for Slurm and for shells, and shards.

#include <gtest/gtest.h>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"
#include "tools/screed/campaign/campaign_work.h"

namespace screed {
namespace {

TEST(Slurm, TimesAreWholeMinutesUp) {
  EXPECT_EQ(slurm::time_text(1.0), "0-00:01:00");
  EXPECT_EQ(slurm::time_text(60.0), "0-00:01:00");
  EXPECT_EQ(slurm::time_text(61.0), "0-00:02:00");
  EXPECT_EQ(slurm::time_text(86400.0 + 3600.0 * 2 + 59.0), "1-02:01:00");
}

TEST(Slurm, QuotesForAShell) {
  EXPECT_EQ(slurm::quoted("a b"), "'a b'");
  EXPECT_EQ(slurm::quoted("it's $HOME"), R"('it'\''s $HOME')");
}

TEST(Slurm, ReadsTheLineOfAShard) {
  const TempFolder folder;
  const std::string file = (folder.path() / "shards").string();
  write_text(file, "0 2 4\n1 3\n9\n");
  CampaignPlan plan;
  plan.cells.resize(1);
  plan.settings.seeds = {1, 2, 3, 4, 5};
  EXPECT_EQ(read_shard(file + ":0", plan), (std::vector<size_t>{0, 2, 4}));
  EXPECT_EQ(read_shard(file + ":1", plan), (std::vector<size_t>{1, 3}));
  EXPECT_THROW(read_shard(file + ":2", plan), InputError);  // a run that there is not
  EXPECT_THROW(read_shard(file + ":3", plan), InputError);
  EXPECT_THROW(read_shard(file, plan), InputError);
  EXPECT_THROW(read_shard(file + ":x", plan), InputError);
  EXPECT_THROW(read_shard("gone:0", plan), InputError);
}

}  // namespace
}  // namespace screed
