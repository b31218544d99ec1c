// Campaigns as the user names them.
#include "tools/screed/campaign/campaign_work.h"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <system_error>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/engine/host.h"
#include "host_sim/run/experiment/experiment_keys.h"
#include "tools/screed/cli/interrupt.h"

namespace screed {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What a kept trial must agree with, beside the host.
Json trial_key(const CampaignPlan& plan) {
  return {{"first", plan.ids.front()}, {"last", plan.ids.back()}};
}

void keep_trial(const CampaignPlan& plan, const CampaignTrial& trial,
                const CampaignFolder& folder) {
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

}  // namespace

ChosenCampaign choose_campaign(const CampaignChoice& choice, const std::string& version) {
  ChosenCampaign chosen;
  const std::string counted = choice.as_version.value_or(version);
  std::error_code error;
  if (fs::is_directory(choice.file, error)) {
    chosen.folder.path = choice.out.value_or(choice.file);
    chosen.plan = read_plan(CampaignFolder{choice.file}.plan());
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

CampaignLock::CampaignLock(const CampaignFolder& folder)
    : FolderLock(folder.path, "another `screed campaign run` works on this campaign") {}

void save_plan(const CampaignPlan& plan, const CampaignFolder& folder) {
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

EngineOptions engine_options(const CampaignFolder& folder) {
  EngineOptions options;
  options.results = folder.results();
  options.log = folder.log();
  options.worker_arguments = {"campaign", "worker", folder.path.string()};
  options.stop = &interrupted();
  return options;
}

std::optional<CampaignTrial> kept_trial(const CampaignPlan& plan, const CampaignFolder& folder) {
  const Json json = Json::parse(read_text(folder.trial()), nullptr, false);
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

CampaignTrial find_trial(const CampaignPlan& plan, const CampaignFolder& folder, bool quiet) {
  std::optional<CampaignTrial> kept = kept_trial(plan, folder);
  if (kept.has_value() && kept->host == host_name()) return std::move(*kept);
  if (!quiet) std::cerr << "trying some runs, for their time and memory ...\n";
  CampaignTrial trial = try_campaign(plan, engine_options(folder));
  keep_trial(plan, trial, folder);
  return trial;
}

std::vector<SlurmJob> slurm_jobs(const CampaignFolder& folder) {
  std::vector<SlurmJob> jobs;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder.slurm(), error)) {
    std::istringstream text(read_text(entry.path() / "job"));
    std::string number;
    if (text >> number) jobs.push_back({number, entry.path()});
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

}  // namespace screed
