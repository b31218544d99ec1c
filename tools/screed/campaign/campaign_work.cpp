// Campaigns as the user names them.
#include "tools/screed/campaign/campaign_work.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <sstream>
#include <system_error>

#include "host_sim/campaign/campaign_results.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/child_process.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/core/json.h"
#include "host_sim/engine/task_engine.h"
#include "host_sim/engine/task_folder.h"
#include "host_sim/run/experiment/experiment_keys.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What a kept trial must agree with, beside the host.
Json trial_key(const CampaignPlan& plan) {
  return {{"first", plan.ids.front()}, {"last", plan.ids.back()}};
}

void keep_trial(const CampaignPlan& plan, const CampaignTrial& trial, const TaskFolder& folder) {
  Json costs = Json::array();
  for (const RunCost& cost : trial.costs) {
    costs.push_back({{"setup_s", cost.setup_s},
                     {"per_second_s", cost.per_second_s},
                     {"finish_s", cost.finish_s}});
  }
  const Json json = {{"host", host_name()},
                     {"key", trial_key(plan)},
                     {"memory_mb", trial.memory_mb},
                     {"costs", costs}};
  write_file(folder.trial(), json.dump(1) + "\n");
}

constexpr size_t kFailuresShown = 10;
constexpr double kMemoryMargin = 1.25;  ///< a run may need more than its trial

}  // namespace

ChosenCampaign choose_campaign(const CampaignChoice& choice, const std::string& version) {
  ChosenCampaign chosen;
  const std::string counted = choice.as_version.value_or(version);
  std::error_code error;
  if (fs::is_directory(choice.file, error)) {
    chosen.folder.path = choice.out.value_or(choice.file);
    chosen.plan = read_plan(TaskFolder{choice.file}.plan());
    if (chosen.plan.version != counted) {
      throw InputError(choice.file + ": is a campaign of version " + chosen.plan.version +
                       ", this is " + counted +
                       "; name the campaign file to run it anew, or say --as-version " +
                       chosen.plan.version + " if nothing that matters to runs has changed");
    }
  } else {
    chosen.plan = make_plan(read_campaign_file(choice.file), counted);
    chosen.folder.path =
        choice.out.value_or((fs::path("out") / chosen.plan.settings.name).string());
  }
  chosen.folder.path = fs::absolute(chosen.folder.path).lexically_normal();
  for (const std::string& note : resolve_run(chosen.plan, 0).experiment.notes)
    std::cerr << "note: " << note << "\n";
  return chosen;
}

CampaignLock::CampaignLock(const TaskFolder& folder)
    : FolderLock(folder.path, "another `screed campaign run` works on this campaign") {}

void save_plan(const CampaignPlan& plan, const TaskFolder& folder) {
  make_folder(folder.path);
  const std::string text = plan_text(plan);
  if (read_text(folder.plan()) != text) write_file(folder.plan(), text);
}

void note_odd_results(const CampaignPlan& plan, const ResultIndex& results) {
  const std::set<std::string> known(plan.ids.begin(), plan.ids.end());
  for (const std::string& note :
       results.oddities([&known](const std::string& id) { return known.contains(id); }))
    std::cerr << "note: " << note << "\n";
}

void merge_and_note(const CampaignPlan& plan, const ResultIndex& results,
                    const TaskFolder& folder) {
  const std::map<std::string, size_t> arithmetics = merge_results(plan, results, folder);
  if (arithmetics.size() < 2) return;
  std::string list;
  for (const auto& [name, runs] : arithmetics)
    list += (list.empty() ? "" : ", ") + std::to_string(runs) + " with '" + name + "'";
  std::cerr << "note: " << folder.path.string()
            << ": runs of several arithmetics, whose bits differ: " << list << "\n";
}

EngineOptions engine_options(const TaskFolder& folder) {
  return {folder, {"campaign", "worker", folder.path.string()}, &interrupted()};
}

std::optional<CampaignTrial> kept_trial(const CampaignPlan& plan, const TaskFolder& folder) {
  const Json json = Json::parse_or_null(read_text(folder.trial()));
  if (!json.is_object() || json.value("key", Json()) != trial_key(plan)) return std::nullopt;
  CampaignTrial trial;
  trial.host = json.value("host", "");
  trial.memory_mb = json.value("memory_mb", 0.0);
  for (const Json& cost : json.value("costs", Json::array())) {
    trial.costs.push_back(
        {cost.value("setup_s", 0.0), cost.value("per_second_s", 0.0), cost.value("finish_s", 0.0)});
  }
  return trial;
}

CampaignTrial find_trial(const CampaignPlan& plan, const TaskFolder& folder, bool quiet) {
  std::optional<CampaignTrial> kept = kept_trial(plan, folder);
  if (kept.has_value() && kept->host == host_name()) return std::move(*kept);
  if (!quiet) std::cerr << "trying some runs, for their time and memory ...\n";
  CampaignTrial trial = try_campaign(plan, engine_options(folder));
  keep_trial(plan, trial, folder);
  return trial;
}

CampaignJob whole_job(const ChosenCampaign& campaign, bool quiet) {
  const CampaignPlan& plan = campaign.plan;
  save_plan(plan, campaign.folder);
  const ResultIndex results(campaign.folder.results());
  note_odd_results(plan, results);
  CampaignJob job;
  const bool is_known =
      plan.settings.time_limit_s.has_value() && plan.settings.memory_mb.has_value();
  if (!is_known && !count_results(plan, results).complete())
    job.trial = find_trial(plan, campaign.folder, quiet);
  job.runs.resize(plan.run_count());
  std::iota(job.runs.begin(), job.runs.end(), size_t{0});
  return job;
}

int worker_count(std::optional<int> wanted, const CampaignPlan& plan,
                 const std::optional<CampaignTrial>& trial) {
  const int asked = wanted.value_or(usable_processors());
  double memory_mb = trial.has_value() ? trial->memory_mb * kMemoryMargin : 0.0;
  memory_mb = plan.settings.memory_mb.value_or(memory_mb);
  const int fit = workers_that_fit(memory_mb, asked);
  if (fit < asked)
    std::cerr << "note: " << fit << " of " << asked << " workers: each needs " << memory_mb
              << " MB of memory\n";
  return fit;
}

namespace {

/// Roughly: seconds, minutes or hours.
std::string rough_time(double seconds) {
  if (seconds < 90.0) return filled("{:.0f} s", seconds);
  if (seconds < 5400.0) return filled("{:.0f} min", seconds / 60.0);
  return filled("{:.1f} h", seconds / 3600.0);
}

std::string runs_text(size_t count) {
  return std::to_string(count) + (count == 1 ? " run" : " runs");
}

}  // namespace

std::string work_text(const CampaignPlan& plan, const std::vector<size_t>& missing, int workers,
                      const std::optional<CampaignTrial>& trial) {
  std::string text = runs_text(missing.size());
  if (missing.size() < plan.run_count()) text += " of " + std::to_string(plan.run_count());
  text += " to make, " + std::to_string(workers) + " at a time";
  if (!trial.has_value()) return text;
  double all_s = 0.0;
  double longest_s = 0.0;
  for (const size_t run : missing) {
    all_s += trial->mean_s(plan.duration_of(run));
    longest_s = std::max(longest_s, trial->greatest_s(plan.duration_of(run)));
  }
  return text + ": about " + rough_time(std::max(all_s / workers, longest_s)) + ", the longest " +
         rough_time(longest_s) + " (a guess from short trials of " +
         runs_text(trial->costs.size()) + ")";
}

void note_work(const ChosenCampaign& campaign, const CampaignJob& job) {
  const ResultIndex results(campaign.folder.results());
  std::vector<size_t> missing;
  for (const size_t run : job.runs) {
    if (!results.done(campaign.plan.ids[run])) missing.push_back(run);
  }
  if (!missing.empty())
    std::cerr << work_text(campaign.plan, missing, job.workers, job.trial) << "\n";
}

void show_failures(const EngineOutcome& outcome) {
  for (size_t i = 0; i < outcome.failures.size() && i < kFailuresShown; ++i)
    std::cerr << "note: " << outcome.failures[i] << "\n";
  if (outcome.failures.size() > kFailuresShown)
    std::cerr << "note: and " << outcome.failures.size() - kFailuresShown << " failed runs more\n";
}

EngineOutcome execute(const ChosenCampaign& campaign, CampaignJob job, bool quiet) {
  std::optional<ProgressBar> bar;
  if (!quiet) {
    bar.emplace(std::cerr);
    job.progress = [&bar](const EngineProgress& progress) {
      std::string note = std::to_string(progress.done) + "/" + std::to_string(progress.tasks);
      if (progress.failed > 0) note += ", " + std::to_string(progress.failed) + " failed";
      bar->show_share(progress.share, note);
    };
  }
  try {
    EngineOutcome outcome = run_campaign(campaign.plan, engine_options(campaign.folder), job);
    if (bar.has_value()) bar->clear();
    return outcome;
  } catch (const RunError& error) {
    if (bar.has_value()) bar->clear();
    throw RunError(std::string(error.what()) +
                   "; what was finished is kept, the same command goes on");
  }
}

std::vector<SlurmJob> slurm_jobs(const TaskFolder& folder) {
  std::vector<SlurmJob> jobs;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder.slurm(), error)) {
    std::istringstream text(read_text(entry.path() / "job"));
    std::string number;
    if (!(text >> number)) continue;
    if (!slurm::is_job_id(number))
      throw InputError((entry.path() / "job").string() + ": '" + number + "' is no id of a job");
    jobs.push_back({number, entry.path()});
  }
  std::sort(jobs.begin(), jobs.end(),
            [](const SlurmJob& a, const SlurmJob& b) { return a.folder < b.folder; });
  return jobs;
}

std::vector<size_t> read_shard(const std::string& text, const CampaignPlan& plan) {
  const size_t colon = text.rfind(':');
  size_t wanted = 0;
  if (colon == std::string::npos || !parse_number(text.substr(colon + 1), wanted))
    throw InputError("--shard " + text + ": expected FILE:LINE");
  std::istringstream lines(read_text(text.substr(0, colon)));
  std::string line;
  for (size_t at = 0; at <= wanted; ++at)
    if (!std::getline(lines, line)) throw InputError("--shard " + text + ": no such line");
  std::istringstream words(line);
  std::vector<size_t> runs;
  for (size_t run = 0; words >> run;) {
    if (run >= plan.run_count())
      throw InputError("--shard " + text + ": the campaign has no run " + std::to_string(run));
    runs.push_back(run);
  }
  return runs;
}

// ---- Slurm's programs, by their output ----

namespace slurm {
namespace {

/// What a program of Slurm says. Clusters add notices of their own to both.
struct Answer {
  int exit_code;
  std::string out;
  std::string err;

  /// The first line, for messages.
  [[nodiscard]] std::string first_line() const {
    const std::string& text = err.empty() ? out : err;
    return text.substr(0, text.find('\n'));
  }
};

Answer run(const std::string& command) {
  std::string errors = (fs::temp_directory_path() / "screed-slurm.XXXXXX").string();
  const int file = mkstemp(errors.data());
  if (file < 0) throw RunError(errors + ": cannot be made: " + std::strerror(errno));
  close(file);
  const ShellOutput output = shell_output(command + " 2>" + slurm::quoted(errors));
  Answer answer{output.exit_code, output.text, read_text(errors)};
  std::error_code ignored;
  fs::remove(errors, ignored);
  return answer;
}

}  // namespace

bool is_job_id(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

int max_array_size() {
  const Answer answer = run("scontrol show config");
  if (answer.exit_code != 0) throw RunError("Slurm does not answer: " + answer.first_line());
  std::istringstream lines(answer.out);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("MaxArraySize", 0) != 0) continue;
    return std::atoi(line.substr(line.find('=') + 1).c_str());
  }
  throw RunError("Slurm does not say MaxArraySize");
}

std::string submit(const std::string& script) {
  const Answer answer = run("sbatch --parsable " + quoted(script));
  if (answer.exit_code != 0) throw RunError("sbatch: " + answer.first_line());
  std::string job;
  std::istringstream lines(answer.out);
  for (std::string line; std::getline(lines, line);) {
    line.resize(std::min(line.find(';'), line.size()));  // "12", or "12;cluster"
    if (is_job_id(line)) job = line;
  }
  if (job.empty()) {
    throw RunError("sbatch says no job id, but '" + answer.first_line() +
                   "'; squeue shows whether there is a job all the same");
  }
  return job;
}

int active_tasks(const std::string& job) {
  const Answer answer = run("squeue --noheader --array --format=%i --jobs=" + quoted(job));
  if (answer.exit_code == 0) {
    int tasks = 0;
    std::istringstream lines(answer.out);
    for (std::string line; std::getline(lines, line);)
      if (line == job || line.starts_with(job + "_")) ++tasks;
    return tasks;
  }
  // Slurm forgets jobs some minutes after their end.
  if (answer.err.find("Invalid job id") != std::string::npos) return 0;
  throw RunError("Slurm does not answer: " + answer.first_line());
}

std::string time_text(double seconds) {
  const auto minutes = static_cast<long>(std::ceil(seconds / 60.0));
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%ld-%02ld:%02ld:00", minutes / 1440, minutes / 60 % 24,
                minutes % 60);
  return text.data();
}

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace slurm

}  // namespace screed
