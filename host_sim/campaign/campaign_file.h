// A campaign: one experiment, run many times with other values and seeds, as read from an INI file.
//
// Reading is strict as that of experiments is: whatever is unknown or not allowed ends with one
// line that names file, line, key and what is allowed. `screed campaign plan --keys` lists the
// keys, from the same table.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/run/experiment/experiment.h"

namespace screed {

/// Section of what an experiment file does not say: `world.hal`, `world.board`.
inline constexpr const char* kWorldSection = "world";

/// A key of experiment files, or of the world.
struct CampaignKey {
  std::string section;
  std::string name;

  std::string text() const { return section + "." + name; }
  bool operator==(const CampaignKey&) const = default;
};

/// What changes from cell to cell: keys that always have the same value as each other, or levels
/// with a name, each of which sets several keys.
struct CampaignFactor {
  std::string heading;            ///< as in the file: "soil.preset", "vehicle.x + vehicle.y", "bed"
  std::vector<CampaignKey> keys;  ///< none where its levels have names
  std::vector<std::string> values;
  std::string where;  ///< place in the file, as messages call it
  /// What each of the named levels sets, by its name.
  std::map<std::string, std::vector<IniEntry>> levels = {};
};

/// What is kept of a run.
enum class CampaignKeep : uint8_t {
  kSummary,  ///< its summary
  kCurves,   ///< and its leveling curve
  kSession,  ///< and its whole run folder
};
const char* keep_name(CampaignKeep keep);
std::optional<CampaignKeep> keep_of(const std::string& name);

struct CampaignSettings {
  std::string name;
  std::vector<uint64_t> seeds = {1};
  std::vector<CampaignKey> seed_keys;
  CampaignKeep keep = CampaignKeep::kSummary;
  std::optional<double> time_limit_s;  ///< of the clock, for one run; left out: from a trial
  std::optional<double> memory_mb;     ///< of one worker; left out: from a trial
  int retries = 1;                     ///< of a run that crashed or passed its limit
  std::optional<int> shard;            ///< runs of a task on a cluster; left out: from a trial
};

struct CampaignFile {
  std::filesystem::path path;
  CampaignSettings settings;
  ExperimentFile experiment;
  std::vector<CampaignFactor> fixed;  ///< [set], one value each
  /// Their levels are combined, each with each; those of the list and of the samples change
  /// together.
  std::vector<CampaignFactor> grid;
  std::vector<CampaignFactor> list;
  std::vector<CampaignFactor> samples;
};

/// Throws InputError.
CampaignFile read_campaign_file(const std::filesystem::path& path);
/// The same of entries that were read from a file, or that stand for such ones.
CampaignFile make_campaign_file(const std::filesystem::path& path,
                                const std::vector<IniEntry>& entries);

/// The keys of [campaign], [random] and [latin_hypercube], one line each, for the documentation.
std::string campaign_key_table();

}  // namespace screed
