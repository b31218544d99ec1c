// The folder of a campaign: what lies where in it.
#pragma once

#include <filesystem>

namespace screed {

struct CampaignFolder {
  std::filesystem::path path;

  std::filesystem::path plan() const { return path / "plan.json"; }
  std::filesystem::path results() const { return path / "results"; }
  /// Run folders by identity, where whole sessions are kept.
  std::filesystem::path runs() const { return path / "runs"; }
  std::filesystem::path trial() const { return path / "trial.json"; }
  std::filesystem::path log() const { return path / "workers.log"; }
  /// A folder for each job array: its shards, script, number and logs.
  std::filesystem::path slurm() const { return path / "slurm"; }
};

}  // namespace screed
