// Campaign files: settings by a table, factors by the table of experiment keys.
#include "host_sim/campaign/campaign_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <system_error>

#include "host_sim/campaign/campaign_values.h"
#include "host_sim/core/csv_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/core/name_list.h"
#include "host_sim/run/experiment/experiment_keys.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSections[] = {"campaign", "set",    "grid",
                                     "list",     "random", "latin_hypercube"};
constexpr const char* kDefaultSeedKeys = "experiment.seed + parameters.random_seed";
constexpr int kMaxSamples = 1'000'000;

/// [random] or [latin_hypercube].
struct Sampling {
  int count = 0;
  uint64_t seed = 1;
};

/// Name of a factor with named levels, and of a level.
using LevelName = std::pair<std::string, std::string>;

/// What is being read.
struct Reading {
  CampaignFile campaign;
  std::string base;  ///< name of the experiment file
  /// The sections of named levels.
  std::map<LevelName, std::vector<IniEntry>> levels;
};

/// One key that is no factor: how its value is read, and what stands in the documentation.
template <class Target>
struct Setting {
  const char* name;
  const char* unit;
  const char* initial;
  const char* allowed;
  const char* meaning;
  /// False: not allowed. `where` for what says itself what is wrong.
  bool (*set)(Target&, const std::string& text, const std::string& where);
};

/// Both ends allowed.
template <class Number>
bool take_number(const std::string& text, Number low, Number high, Number& value) {
  return parse_number(text, value) && value >= low && value <= high;
}

template <class Number>
bool take_optional(const std::string& text, Number low, Number high, std::optional<Number>& value) {
  Number number{};
  if (!take_number(text, low, high, number)) return false;
  value = number;
  return true;
}

CampaignKey parse_key(const std::string& text, const std::string& where) {
  const size_t begin = text.find_first_not_of(' ');
  const size_t end = text.find_last_not_of(' ');
  const std::string name = begin == std::string::npos ? "" : text.substr(begin, end + 1 - begin);
  const size_t dot = name.find('.');
  if (dot == std::string::npos || dot == 0) {
    throw InputError(where + ": '" + name +
                     "': expected section.key of an experiment file, such as vehicle.x, or "
                     "world.hal or world.board");
  }
  CampaignKey key{name.substr(0, dot), name.substr(dot + 1)};
  if (key.section != kWorldSection) {
    find_experiment_key(key.section, key.name, where);
  } else if (key.name != "hal" && key.name != "board") {
    throw InputError(where + ": unknown key '" + key.name + "' in world; known are hal, board");
  }
  return key;
}

/// Keys joined by +.
std::vector<CampaignKey> parse_keys(const std::string& heading, const std::string& where) {
  std::vector<CampaignKey> keys;
  for (size_t begin = 0; begin <= heading.size();) {
    const size_t end = std::min(heading.find('+', begin), heading.size());
    keys.push_back(parse_key(heading.substr(begin, end - begin), where));
    begin = end + 1;
  }
  return keys;
}

bool is_name(const std::string& text) {
  return !text.empty() && text.size() <= 64 &&
         text.find_first_not_of(
             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") ==
             std::string::npos;
}

constexpr Setting<Reading> kSettings[] = {
    {"name", "", "name of the file", "letters, digits, _ and -; at most 64",
     "names the campaign's folder",
     [](Reading& r, const std::string& text, const std::string&) {
       r.campaign.settings.name = text;
       return is_name(text);
     }},
    {"experiment", "", "", "an experiment file, or the name of one that comes with Screed",
     "what the runs have in common; looked for beside the campaign file first; required",
     [](Reading& r, const std::string& text, const std::string&) {
       r.base = text;
       return !text.empty();
     }},
    {"seeds", "", "1", "seeds and ranges of seeds, as 1..30 or 1, 2, 10..20",
     "every combination of factors runs once with each",
     [](Reading& r, const std::string& text, const std::string& where) {
       r.campaign.settings.seeds = parse_seeds(text, where);
       return true;
     }},
    {"seed_keys", "", kDefaultSeedKeys, "keys joined by +", "the keys that a seed is the value of",
     [](Reading& r, const std::string& text, const std::string& where) {
       r.campaign.settings.seed_keys = parse_keys(text, where);
       return true;
     }},
    {"keep", "", "summary", "summary, curves or session",
     "what is kept of a run: its summary; its leveling curve as well; its whole run folder as well",
     [](Reading& r, const std::string& text, const std::string&) {
       const std::optional<CampaignKeep> keep = keep_of(text);
       r.campaign.settings.keep = keep.value_or(CampaignKeep::kSummary);
       return keep.has_value();
     }},
    {"time_limit", "s", "from a trial", "a number 0.1..1e7",
     "a run that takes longer is ended and counts as failed",
     [](Reading& r, const std::string& text, const std::string&) {
       return take_optional(text, 0.1, 1e7, r.campaign.settings.time_limit_s);
     }},
    {"memory", "MB", "from a trial", "a number 1..1e7",
     "memory of a worker; no more of them run than there is memory for",
     [](Reading& r, const std::string& text, const std::string&) {
       return take_optional(text, 1.0, 1e7, r.campaign.settings.memory_mb);
     }},
    {"retries", "", "1", "an integer 0..100",
     "how often a run that crashed or passed its limit is tried again at once",
     [](Reading& r, const std::string& text, const std::string&) {
       return take_number(text, 0, 100, r.campaign.settings.retries);
     }},
    {"shard", "runs", "from a trial", "an integer 1..10000", "runs of one task on a cluster",
     [](Reading& r, const std::string& text, const std::string&) {
       return take_optional(text, 1, 10000, r.campaign.settings.shard);
     }},
};

constexpr Setting<Sampling> kSamplingSettings[] = {
    {"count", "", "", "an integer 1..1000000", "number of samples; required",
     [](Sampling& s, const std::string& text, const std::string&) {
       return take_number(text, 1, kMaxSamples, s.count);
     }},
    {"seed", "", "1", "an integer, 0 or more", "seed of the samples",
     [](Sampling& s, const std::string& text, const std::string&) {
       return parse_number(text, s.seed);
     }},
};

/// Takes an entry that is a setting; `where` is its place. Returns false for another key.
template <class Target, size_t N>
bool take_setting(const Setting<Target> (&settings)[N], Target& target, const IniEntry& entry,
                  const std::string& where) {
  for (const Setting<Target>& setting : settings) {
    if (entry.key != setting.name) continue;
    if (setting.set(target, entry.value, where)) return true;
    throw InputError(where + " = '" + entry.value + "' is not allowed; expected " +
                     setting.allowed + (*setting.unit == '\0' ? "" : " (") + setting.unit +
                     (*setting.unit == '\0' ? "" : ")"));
  }
  return false;
}

template <class Target, size_t N>
std::string setting_names(const Setting<Target> (&settings)[N]) {
  std::vector<std::string> names;
  for (const Setting<Target>& setting : settings) names.emplace_back(setting.name);
  return name_list(names);
}

template <class Target, size_t N>
std::string setting_rows(const char* section, const Setting<Target> (&settings)[N]) {
  std::string text;
  for (const Setting<Target>& s : settings) {
    text += std::string("| ") + section + " " + s.name + " | " + s.unit + " | " + s.initial +
            " | " + s.allowed + " | " + s.meaning + " |\n";
  }
  return text;
}

std::string line_place(const fs::path& path, int line) {
  return path.string() + ":" + std::to_string(line);
}

/// A factor whose levels have sections of their own: its name is no key of an experiment.
bool has_named_levels(const std::string& heading) {
  return is_name(heading);
}

/// The name of a level, of a section such as [bed rough].
std::optional<LevelName> level_of_section(const std::string& section) {
  const size_t space = section.find(' ');
  if (space == std::string::npos) return std::nullopt;
  const LevelName name{section.substr(0, space), section.substr(space + 1)};
  if (!is_name(name.first) || !is_name(name.second)) return std::nullopt;
  return name;
}

CampaignFactor factor_of(const IniEntry& entry, const std::string& where) {
  CampaignFactor factor{entry.key, {}, split_csv_line(entry.value, where), where};
  if (!has_named_levels(entry.key)) factor.keys = parse_keys(entry.key, where);
  if (std::find(factor.values.begin(), factor.values.end(), "") != factor.values.end())
    throw InputError(where + " = '" + entry.value + "': a value is empty");
  return factor;
}

/// A range of a sampling section.
struct SampledKeys {
  CampaignFactor factor;  ///< without values
  SampleRange range;
  uint64_t multiple_of = 0;
};

SampledKeys sampled_of(const IniEntry& entry, const std::string& where) {
  SampledKeys sampled;
  sampled.factor = {entry.key, parse_keys(entry.key, where), {}, where};
  sampled.range = parse_range(entry.value, where);
  for (const CampaignKey& key : sampled.factor.keys) {
    if (key.section == kWorldSection)
      throw InputError(where + ": " + key.text() + " has no range; it belongs in [grid] or [list]");
    sampled.multiple_of = std::max(sampled.multiple_of,
                                   find_experiment_key(key.section, key.name, where).multiple_of);
  }
  const auto step = static_cast<double>(sampled.multiple_of);
  if (step > 0.0 && std::floor(sampled.range.high / step) < std::ceil(sampled.range.low / step)) {
    throw InputError(where + " = '" + entry.value + "': the range holds no multiple of " +
                     std::to_string(sampled.multiple_of));
  }
  return sampled;
}

/// The factors of [random] or [latin_hypercube].
std::vector<CampaignFactor> read_samples(const std::vector<IniEntry>& entries, const fs::path& path,
                                         const std::string& section) {
  Sampling sampling;
  std::vector<SampledKeys> sampled;
  for (const IniEntry& entry : entries) {
    const std::string where = entry_place(path, entry);
    if (take_setting(kSamplingSettings, sampling, entry, where)) continue;
    sampled.push_back(sampled_of(entry, where));
  }
  if (entries.empty()) return {};
  const std::string whole = line_place(path, entries.front().line) + ": [" + section + "]";
  if (sampling.count == 0) throw InputError(whole + " has no count, the number of samples");
  if (sampled.empty())
    throw InputError(whole + " has no range, such as soil.slip_layer = 0.001..0.004");
  const auto count = static_cast<size_t>(sampling.count);
  const auto shares = section == "random"
                          ? random_sample(count, sampled.size(), sampling.seed)
                          : latin_hypercube_sample(count, sampled.size(), sampling.seed);
  std::vector<CampaignFactor> factors;
  for (size_t d = 0; d < sampled.size(); ++d) {
    CampaignFactor factor = sampled[d].factor;
    for (const std::vector<double>& sample : shares)
      factor.values.push_back(value_in_range(sampled[d].range, sample[d], sampled[d].multiple_of));
    factors.push_back(std::move(factor));
  }
  return factors;
}

/// The columns of [list] are as long as each other.
void check_list(const std::vector<CampaignFactor>& list) {
  for (const CampaignFactor& column : list) {
    if (column.values.size() == list.front().values.size()) continue;
    throw InputError(column.where + ": " + std::to_string(column.values.size()) +
                     " values; expected " + std::to_string(list.front().values.size()) +
                     ", as of " + list.front().heading);
  }
}

/// No key stands in two places, but in several factors with named levels: of those the later one
/// holds.
void check_unique(const CampaignFile& campaign) {
  std::vector<std::pair<CampaignKey, std::string>> seen;
  for (const CampaignKey& key : campaign.settings.seed_keys)
    seen.emplace_back(key, "[campaign] seed_keys");
  for (const auto* factors : {&campaign.fixed, &campaign.grid, &campaign.list, &campaign.samples}) {
    for (const CampaignFactor& factor : *factors) {
      for (const CampaignKey& key : factor.keys) {
        const auto same = std::find_if(seen.begin(), seen.end(),
                                       [&](const auto& other) { return other.first == key; });
        if (same != seen.end())
          throw InputError(factor.where + ": " + key.text() + " has its values from " +
                           same->second + " already");
        seen.emplace_back(key, factor.where);
      }
    }
  }
  for (const auto* factors : {&campaign.grid, &campaign.list}) {
    for (const CampaignFactor& factor : *factors) {
      for (const auto& [name, entries] : factor.levels) {
        for (const IniEntry& entry : entries) {
          const CampaignKey key{entry.section, entry.key};
          const auto same = std::find_if(seen.begin(), seen.end(),
                                         [&](const auto& other) { return other.first == key; });
          if (same != seen.end())
            throw InputError(line_place(campaign.path, entry.line) + ": [" + factor.heading + " " +
                             name + "] " + key.text() + " has its values from " + same->second +
                             " already");
        }
      }
    }
  }
}

/// The base experiment: beside the campaign file, else as `screed sim` finds it.
ExperimentFile read_base(const fs::path& path, const std::string& name) {
  std::error_code error;
  const fs::path beside = path.parent_path() / name;
  if (fs::is_regular_file(beside, error)) return read_experiment_file(beside);
  return read_experiment_file(name);
}

void take_entry(Reading& reading, const IniEntry& entry) {
  const fs::path& path = reading.campaign.path;
  const std::string where = entry_place(path, entry);
  if (entry.section == "campaign") {
    if (!take_setting(kSettings, reading, entry, where))
      throw InputError(line_place(path, entry.line) + ": unknown key '" + entry.key +
                       "' in [campaign]; known are " + setting_names(kSettings));
  } else if (entry.section == "set") {
    reading.campaign.fixed.push_back(
        {entry.key, parse_keys(entry.key, where), {entry.value}, where});
  } else if (entry.section == "grid") {
    reading.campaign.grid.push_back(factor_of(entry, where));
  } else if (entry.section == "list") {
    reading.campaign.list.push_back(factor_of(entry, where));
  } else if (const std::optional<LevelName> level = level_of_section(entry.section)) {
    const CampaignKey key = parse_key(entry.key, where);
    reading.levels[*level].push_back({key.section, key.name, entry.value, entry.line});
  } else {
    std::string known;
    for (const char* section : kSections)
      known.append(known.empty() ? "[" : ", [").append(section).append("]");
    throw InputError(line_place(path, entry.line) +
                     (entry.section.empty() ? ": key '" + entry.key + "' before the first section"
                                            : ": unknown section [" + entry.section + "]") +
                     "; known are " + known + ", and of a factor with named levels [FACTOR LEVEL]");
  }
}

[[noreturn]] void refuse_level(const CampaignFactor& factor, const std::string& value) {
  throw InputError(factor.where + ": no section [" + factor.heading + " " + value + "] says what " +
                   value + " is");
}

/// Gives the factors their named levels. Each has its section, and each section its level.
void take_levels(Reading& reading) {
  CampaignFile& campaign = reading.campaign;
  std::set<LevelName> used;
  for (auto* factors : {&campaign.grid, &campaign.list}) {
    for (CampaignFactor& factor : *factors) {
      if (!factor.keys.empty()) continue;
      for (const std::string& value : factor.values) {
        const LevelName name{factor.heading, value};
        const auto level = reading.levels.find(name);
        if (level == reading.levels.end()) refuse_level(factor, value);
        factor.levels.insert({value, level->second});
        used.insert(name);
      }
    }
  }
  for (const auto& [name, entries] : reading.levels) {
    if (used.contains(name)) continue;
    throw InputError(line_place(campaign.path, entries.front().line) + ": [" + name.first + " " +
                     name.second + "] is the level of no factor; expected " + name.second +
                     " among the values of " + name.first + " in [grid] or [list]");
  }
}

}  // namespace

const char* keep_name(CampaignKeep keep) {
  switch (keep) {
    case CampaignKeep::kSummary:
      return "summary";
    case CampaignKeep::kCurves:
      return "curves";
    case CampaignKeep::kSession:
      return "session";
  }
  return "";
}

std::optional<CampaignKeep> keep_of(const std::string& name) {
  for (const CampaignKeep keep :
       {CampaignKeep::kSummary, CampaignKeep::kCurves, CampaignKeep::kSession})
    if (name == keep_name(keep)) return keep;
  return std::nullopt;
}

CampaignFile read_campaign_file(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    throw InputError(path.string() + ": no such campaign file");
  return make_campaign_file(path, read_ini_file(path));
}

CampaignFile make_campaign_file(const fs::path& path, const std::vector<IniEntry>& entries) {
  Reading reading;
  CampaignFile& campaign = reading.campaign;
  campaign.path = path;
  campaign.settings.name = path.stem().string();
  campaign.settings.seed_keys = parse_keys(kDefaultSeedKeys, "");
  std::vector<IniEntry> random;
  std::vector<IniEntry> hypercube;
  for (const IniEntry& entry : entries) {
    if (entry.section == "random") {
      random.push_back(entry);
    } else if (entry.section == "latin_hypercube") {
      hypercube.push_back(entry);
    } else {
      take_entry(reading, entry);
    }
  }
  if (reading.base.empty())
    throw InputError(path.string() +
                     ": [campaign] has no experiment, the file of what the runs "
                     "have in common");
  if (!is_name(campaign.settings.name))
    throw InputError(path.string() +
                     ": [campaign] has no name, and that of the file is none: "
                     "expected " +
                     kSettings[0].allowed);
  if (!random.empty() && !hypercube.empty())
    throw InputError(line_place(path, hypercube.front().line) +
                     ": [latin_hypercube] beside [random]; a campaign has one of them");
  campaign.experiment = read_base(path, reading.base);
  campaign.samples = random.empty() ? read_samples(hypercube, path, "latin_hypercube")
                                    : read_samples(random, path, "random");
  take_levels(reading);
  check_list(campaign.list);
  check_unique(campaign);
  return std::move(reading.campaign);
}

std::string campaign_key_table() {
  return setting_rows("[campaign]", kSettings) +
         setting_rows("[random], [latin_hypercube]", kSamplingSettings);
}

}  // namespace screed
