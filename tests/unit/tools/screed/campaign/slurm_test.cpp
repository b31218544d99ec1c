// Texts for Slurm and for shells, shards, and what Slurm's programs print.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"
#include "tools/screed/campaign/campaign_work.h"

namespace screed {
namespace {

// What is said before the runs of a campaign begin.
TEST(WorkText, SaysHowManyRunsAndAboutHowLong) {
  CampaignPlan plan;
  plan.cells.resize(2);
  plan.durations_s = {600.0, 1200.0};
  plan.settings.seeds = {1, 2, 3};
  CampaignTrial trial;
  trial.costs = {{1.0, 0.1, 4.0}, {2.0, 0.3, 3.0}};  // means: 5 s, and 0.2 s for a second
  // Runs of 125 s and of 245 s, at most 185 s and 365 s.
  EXPECT_EQ(work_text(plan, {0, 1, 2, 3, 4, 5}, 2, trial),
            "6 runs to make, 2 at a time: about 9 min, the longest 6 min (a guess from short "
            "trials of 2 runs)");
  EXPECT_EQ(work_text(plan, {3}, 4, trial),
            "1 run of 6 to make, 4 at a time: about 6 min, the longest 6 min (a guess from short "
            "trials of 2 runs)");
  trial.costs = {{0.0, 20.0, 0.0}};  // 200 and 400 min: 10 h on a worker each
  EXPECT_EQ(work_text(plan, {0, 1, 2, 3}, 1, trial),
            "4 runs of 6 to make, 1 at a time: about 16.7 h, the longest 6.7 h (a guess from short "
            "trials of 1 run)");
  EXPECT_EQ(work_text(plan, {0, 1}, 2, std::nullopt), "2 runs of 6 to make, 2 at a time");
}

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

/// Programs of these names come first on the path.
class SlurmPrograms : public ::testing::Test {
 protected:
  SlurmPrograms() { setenv("PATH", (folder_.path().string() + ":" + path_).c_str(), 1); }
  ~SlurmPrograms() override { setenv("PATH", path_.c_str(), 1); }

  void program(const char* name, const std::string& script) {
    write_text(folder_.path() / name, "#!/bin/sh\n" + script);
    std::filesystem::permissions(folder_.path() / name, std::filesystem::perms::owner_all);
  }

 private:
  TempFolder folder_;
  std::string path_ = std::getenv("PATH");
};

TEST_F(SlurmPrograms, NoticesAreNoPartOfAJob) {
  program("sbatch", "echo 'sbatch: no partition specified' >&2; echo 4711");
  EXPECT_EQ(slurm::submit("array.sh"), "4711");
  program("sbatch", "echo 'Welcome. Your budget: 12 h'; echo '4711;west'; echo '2 jobs wait'");
  EXPECT_EQ(slurm::submit("array.sh"), "4711");
  program("sbatch", "echo 'Submitted as -'; echo 'sbatch: warned' >&2");
  EXPECT_THROW(slurm::submit("array.sh"), RunError);
  program("sbatch", "echo 'sbatch: error: Batch job submission failed' >&2; exit 1");
  try {
    slurm::submit("array.sh");
    FAIL() << "it failed";
  } catch (const RunError& error) {
    EXPECT_STREQ(error.what(), "sbatch: sbatch: error: Batch job submission failed");
  }
}

TEST_F(SlurmPrograms, TasksInTheQueueAreThoseOfTheJob) {
  program("squeue", "echo 'maintenance on Monday' >&2; echo 'CLUSTER: west'; echo 47_1; echo 47_2");
  EXPECT_EQ(slurm::active_tasks("47"), 2);
  EXPECT_EQ(slurm::active_tasks("4"), 0);
  program("squeue", "echo 47");
  EXPECT_EQ(slurm::active_tasks("47"), 1);
  program("squeue", "echo 'slurm_load_jobs error: Invalid job id specified' >&2; exit 1");
  EXPECT_EQ(slurm::active_tasks("47"), 0);
  program("squeue", "echo 'squeue: error: no controller' >&2; exit 1");
  EXPECT_THROW(slurm::active_tasks("47"), RunError);
  program("scontrol", "echo 'notice' >&2; echo 'MaxArraySize            = 1001'");
  EXPECT_EQ(slurm::max_array_size(), 1001);
}

}  // namespace
}  // namespace screed
