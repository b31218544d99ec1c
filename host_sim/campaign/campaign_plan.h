// What a campaign consists of: its runs, in their order, each with its values and its identity.
//
// Runs are numbered cell by cell, and within a cell by seed. A cell is one combination of the
// factors' values; seeds are the same in all of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_file.h"
#include "host_sim/run/experiment/experiment.h"

namespace screed {

/// Where an experiment runs, besides what it says itself.
struct CampaignWorld {
  std::string hal = "native";  ///< native, mcu or surrogate
  std::string board = kDefaultBoard;
};

/// One run, resolved.
struct CampaignRun {
  Experiment experiment;
  CampaignWorld world;
  CampaignKeep keep = CampaignKeep::kSummary;
};

/// Complete and by itself: the campaign's folder keeps it, and what runs later (another process,
/// another machine) sees the same runs.
struct CampaignPlan {
  std::string version;  ///< of the program that the results are those of
  CampaignSettings settings;
  ExperimentFile experiment;
  std::vector<CampaignFactor> fixed;            ///< [set]
  std::vector<CampaignFactor> factors;          ///< columns; without values
  std::vector<std::vector<std::string>> cells;  ///< values by cell, then column
  std::vector<double> durations_s;              ///< simulated time of a run, by cell
  std::vector<std::string> ids;                 ///< identity by run

  size_t seed_count() const { return settings.seeds.size(); }
  size_t run_count() const { return cells.size() * seed_count(); }
  size_t cell_of(size_t run) const { return run / seed_count(); }
  double duration_of(size_t run) const { return durations_s[cell_of(run)]; }
  uint64_t seed_of(size_t run) const { return settings.seeds[run % seed_count()]; }
};

/// Most runs of a campaign.
inline constexpr size_t kMaxCampaignRuns = 1'000'000;

/// The plan of a file, every run of it resolved. Throws InputError for a value that an experiment
/// does not allow, a missing data file, two cells that are the same.
CampaignPlan make_plan(const CampaignFile& file, const std::string& version);

/// The experiment and the world of one run. Throws InputError.
CampaignRun resolve_run(const CampaignPlan& plan, size_t run);

/// The identity of a run: 32 hexadecimal digits. Equal for runs that give the same results: of the
/// same program version, with the same experiment, world, height map and robot model, of which the
/// same is kept. The campaign's name is not part of it. Throws InputError when a data file is
/// missing.
std::string identity_of(const CampaignRun& run, const std::string& version);

/// The plan as JSON text, and back. Throws InputError that names `file`.
std::string plan_text(const CampaignPlan& plan);
CampaignPlan read_plan(const std::filesystem::path& file);

}  // namespace screed
