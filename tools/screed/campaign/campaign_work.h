// What the subcommands of `screed campaign` have in common: which campaign, in which folder, and
// what stands there.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/campaign/campaign_run.h"
#include "host_sim/engine/result_store.h"
#include "host_sim/engine/task_folder.h"

namespace screed {

/// Which campaign the user means.
struct CampaignChoice {
  std::string file;                       ///< campaign file, or the folder of a campaign
  std::optional<std::string> out;         ///< folder; else out/NAME
  std::optional<std::string> as_version;  ///< counts as the program's version
};

struct ChosenCampaign {
  CampaignPlan plan;
  TaskFolder folder;
};

/// Reads the file, or the plan in the folder, which must be of this version. Notes of the
/// experiment go to standard error. Throws InputError.
ChosenCampaign choose_campaign(const CampaignChoice& choice, const std::string& version);

/// Only one process at a time executes the runs of a folder on one machine.
class CampaignLock : public FolderLock {
 public:
  /// Throws InputError when another process has it, RunError when the folder cannot be written.
  explicit CampaignLock(const TaskFolder& folder);
};

/// Makes the folder and writes the plan where it differs from what is there. Throws RunError.
void save_plan(const CampaignPlan& plan, const TaskFolder& folder);

/// Says on standard error what is odd about the stored results: damaged lines, results of another
/// version or other values.
void note_odd_results(const CampaignPlan& plan, const ResultIndex& results);
/// merge_results(). Says on standard error when the runs are of several arithmetics.
void merge_and_note(const CampaignPlan& plan, const ResultIndex& results, const TaskFolder& folder);

EngineOptions engine_options(const TaskFolder& folder);

/// The trial of this plan on this machine: the one in the folder, or a new one, which is kept
/// there. Shows that it works on standard error unless `quiet`.
CampaignTrial find_trial(const CampaignPlan& plan, const TaskFolder& folder, bool quiet);
/// The trial in the folder, of whatever machine; nothing without one.
std::optional<CampaignTrial> kept_trial(const CampaignPlan& plan, const TaskFolder& folder);

/// All runs, on this machine alone: saves the plan, and tries some runs where their cost is not
/// known.
CampaignJob whole_job(const ChosenCampaign& campaign, bool quiet);
/// How many runs at a time: as many as wanted, else one a processor, no more than memory allows. A
/// note says so.
int worker_count(std::optional<int> wanted, const CampaignPlan& plan,
                 const std::optional<CampaignTrial>& trial);
/// How many runs are still to be made by so many workers, and about how long that takes: what a
/// trial showed, if there was one.
std::string work_text(const CampaignPlan& plan, const std::vector<size_t>& missing, int workers,
                      const std::optional<CampaignTrial>& trial);
/// It on standard error, before the work begins; nothing where none is left.
void note_work(const ChosenCampaign& campaign, const CampaignJob& job);
/// Executes the runs, with a bar unless `quiet`.
EngineOutcome execute(const ChosenCampaign& campaign, CampaignJob job, bool quiet);
/// The first of the failures, on standard error.
void show_failures(const EngineOutcome& outcome);

/// A job array that was submitted.
struct SlurmJob {
  std::string number;
  std::filesystem::path folder;
};
/// Of this campaign, the oldest first. Throws InputError for a kept id that is none.
std::vector<SlurmJob> slurm_jobs(const TaskFolder& folder);

/// The runs of a shard, "FILE:LINE", lines counted from 0. Throws InputError.
std::vector<size_t> read_shard(const std::string& text, const CampaignPlan& plan);

/// Slurm's programs: sbatch, squeue, scontrol. Whatever notices a cluster adds to what they print
/// are passed over.
namespace slurm {

/// Whether this is what Slurm calls a job: digits.
bool is_job_id(const std::string& text);

/// Most tasks of a job array: what the cluster allows. Throws RunError when Slurm does not answer.
int max_array_size();

/// Submits a script. Returns the job's number. Throws RunError with Slurm's own words, also when
/// there is no number among them.
std::string submit(const std::string& script);

/// Tasks of a job that wait or run; 0 of a job that Slurm does not know any more. Throws RunError
/// when Slurm does not answer.
int active_tasks(const std::string& job);

/// Wall time as Slurm takes it, "1-02:30:00", whole minutes from at least this many seconds.
std::string time_text(double seconds);

/// The text of one word for a shell.
std::string quoted(const std::string& word);

}  // namespace slurm

}  // namespace screed
