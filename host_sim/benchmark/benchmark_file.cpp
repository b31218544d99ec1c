// The benchmark's file, and the campaign that comes of it.
#include "host_sim/benchmark/benchmark_file.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "host_sim/campaign/campaign_values.h"
#include "host_sim/core/csv_file.h"
#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/core/name_list.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "host_sim/run/experiment/experiment_keys.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

using Levels = std::map<std::string, std::vector<IniEntry>>;

/// They go where they are told, and level nothing.
constexpr const char* kNoEntries[] = {"drive", "training_drive"};

std::vector<std::string> factor_names() {
  std::vector<std::string> names = {kWorldFactor};
  names.insert(names.end(), std::begin(kCourseFactors), std::end(kCourseFactors));
  names.emplace_back(kEntryFactor);
  return names;
}

[[noreturn]] void refuse_value(const std::string& where, const std::string& value,
                               const std::string& allowed) {
  throw InputError(where + " = '" + value + "' is not allowed; expected " + allowed);
}

/// The names in a list of a suite, each a known level.
std::vector<std::string> levels_in(const Benchmark& benchmark, const std::string& factor,
                                   const std::string& text, const std::string& where) {
  std::vector<std::string> names = split_csv_line(text, where);
  const auto known = benchmark.levels.find(factor);
  for (const std::string& name : names) {
    if (known != benchmark.levels.end() && known->second.contains(name)) continue;
    std::vector<std::string> all;
    if (known != benchmark.levels.end())
      for (const auto& [level, entries] : known->second) all.push_back(level);
    refuse_value(where, name, name_list(all, " or "));
  }
  return names;
}

void take_suite_entry(const Benchmark& benchmark, const IniEntry& entry, BenchmarkSuite& suite) {
  const std::string where = entry_place(benchmark.path, entry);
  const std::vector<std::string> factors = factor_names();
  if (entry.key == "seeds") {
    if (!parse_number(entry.value, suite.seeds) || suite.seeds == 0)
      refuse_value(where, entry.value, "an integer, 1 or more");
  } else if (entry.key == "test_seeds") {
    suite.test_seeds = parse_seeds(entry.value, where);
    for (const std::uint64_t seed : suite.test_seeds) {
      if (std::find(benchmark.test_seeds.begin(), benchmark.test_seeds.end(), seed) !=
          benchmark.test_seeds.end())
        continue;
      refuse_value(where, entry.value, "seeds of [benchmark] test_seeds");
    }
  } else if (entry.key == "duration") {
    double duration_s = 0.0;
    if (!parse_number(entry.value, duration_s) || !(duration_s > 0.0))
      refuse_value(where, entry.value, "a number above 0 (s)");
    suite.duration_s = duration_s;
  } else if (std::find(factors.begin(), factors.end(), entry.key) != factors.end()) {
    suite.levels[entry.key] = levels_in(benchmark, entry.key, entry.value, where);
  } else {
    throw InputError(where + ": unknown key; known are seeds, test_seeds, duration, " +
                     name_list(factors));
  }
}

void take_benchmark_entry(const IniEntry& entry, Benchmark& benchmark) {
  const std::string where = entry_place(benchmark.path, entry);
  if (entry.key == "version") {
    if (!parse_number(entry.value, benchmark.version) || benchmark.version < 1)
      refuse_value(where, entry.value, "an integer, 1 or more");
  } else if (entry.key == "experiment") {
    benchmark.experiment = entry.value;
  } else if (entry.key == "training_seeds") {
    benchmark.training_seeds = parse_seeds(entry.value, where);
  } else if (entry.key == "test_seeds") {
    benchmark.test_seeds = parse_seeds(entry.value, where);
  } else {
    throw InputError(where +
                     ": unknown key; known are version, experiment, training_seeds, test_seeds");
  }
}

/// The two words of a section's name: "bed rough".
std::pair<std::string, std::string> words_of(const std::string& section) {
  const std::size_t space = section.find(' ');
  if (space == std::string::npos) return {section, ""};
  return {section.substr(0, space), section.substr(space + 1)};
}

/// "soil.preset" as a key of an experiment file; of a world also what campaigns know of it.
IniEntry experiment_entry(const std::string& factor, const IniEntry& entry,
                          const std::string& where) {
  const std::size_t dot = entry.key.find('.');
  if (dot == std::string::npos)
    throw InputError(where + ": expected section.key of an experiment file");
  IniEntry result{entry.key.substr(0, dot), entry.key.substr(dot + 1), entry.value, entry.line};
  if (factor == kWorldFactor && result.section == kWorldSection) return result;
  find_experiment_key(result.section, result.key, where);
  return result;
}

bool uses(const std::vector<IniEntry>& entries, const std::string& algorithm) {
  return std::any_of(entries.begin(), entries.end(), [&](const IniEntry& entry) {
    return entry.section == "experiment" && entry.key == "algorithm" && entry.value == algorithm;
  });
}

/// The robot's algorithms that the file does not name.
void add_further_algorithms(Benchmark& benchmark) {
  Levels& entries = benchmark.levels[kEntryFactor];
  for (const std::string& algorithm : value_names("leveling.algorithm")) {
    if (std::find(std::begin(kNoEntries), std::end(kNoEntries), algorithm) != std::end(kNoEntries))
      continue;
    if (std::any_of(entries.begin(), entries.end(),
                    [&](const auto& entry) { return uses(entry.second, algorithm); }))
      continue;
    entries[algorithm] = {{"experiment", "algorithm", algorithm, 0}};
    benchmark.entries.push_back(algorithm);
  }
}

/// A course decides its keys, whoever drives on it; but for the soil's digging, which the baseline
/// of compaction does without.
void check_entry(const Benchmark& benchmark, const fs::path& file,
                 const std::vector<IniEntry>& entries) {
  for (const IniEntry& entry : entries) {
    const bool free = entry.section == "parameters" ||
                      (entry.section == "experiment" && entry.key == "algorithm");
    bool decided = !free;
    for (const char* factor : kCourseFactors) {
      const auto levels = benchmark.levels.find(factor);
      if (levels == benchmark.levels.end()) continue;
      for (const auto& [name, keys] : levels->second) {
        for (const IniEntry& key : keys)
          decided = decided || (key.section == entry.section && key.key == entry.key);
      }
    }
    if (!decided) continue;
    throw InputError(entry_place(file, entry) +
                     ": is not an entry's to say; allowed are [experiment] algorithm and those "
                     "[parameters] that no course of the benchmark decides");
  }
}

[[noreturn]] void refuse_level(const std::string& factor, const std::string& level,
                               const std::vector<std::string>& known) {
  if (factor == kEntryFactor && fs::path(level).has_extension())
    throw InputError(level + ": no such file");
  throw InputError("unknown " + factor + " '" + level + "'; known are " + name_list(known) +
                   (factor == kEntryFactor ? ", or an experiment file with its algorithm" : ""));
}

}  // namespace

fs::path benchmark_path() {
  return data_folders().data / "benchmark" / "leveling.ini";
}

Benchmark read_benchmark(const fs::path& path) {
  Benchmark benchmark;
  benchmark.path = path;
  const std::vector<std::string> factors = factor_names();
  std::vector<IniEntry> of_suites;
  for (const IniEntry& entry : read_ini_file(path)) {
    const auto [kind, name] = words_of(entry.section);
    if (entry.section == "benchmark") {
      take_benchmark_entry(entry, benchmark);
    } else if (kind == "suite" && !name.empty()) {
      of_suites.push_back(entry);
    } else if (!name.empty() && std::find(factors.begin(), factors.end(), kind) != factors.end()) {
      std::vector<IniEntry>& level = benchmark.levels[kind][name];
      if (kind == kEntryFactor && level.empty()) benchmark.entries.push_back(name);
      level.push_back(experiment_entry(kind, entry, entry_place(path, entry)));
    } else {
      throw InputError(
          path.string() + ":" + std::to_string(entry.line) + ": unknown section [" + entry.section +
          "]; known are [benchmark], [suite NAME] and [FACTOR LEVEL] of " + name_list(factors));
    }
  }
  if (benchmark.version == 0 || benchmark.experiment.empty() || benchmark.training_seeds.empty() ||
      benchmark.test_seeds.empty())
    throw InputError(path.string() +
                     ": [benchmark] needs version, experiment, training_seeds and test_seeds");
  add_further_algorithms(benchmark);
  for (const IniEntry& entry : of_suites)
    take_suite_entry(benchmark, entry, benchmark.suites[words_of(entry.section).second]);
  return benchmark;
}

std::string add_entry(const fs::path& file, Benchmark& benchmark) {
  std::string name = file.stem().string();
  std::vector<IniEntry> entries = read_experiment_file(file).entries;
  check_entry(benchmark, file, entries);
  if (!std::any_of(entries.begin(), entries.end(), [](const IniEntry& entry) {
        return entry.section == "experiment" && entry.key == "algorithm";
      }))
    throw InputError(file.string() + ": has no [experiment] algorithm");
  Levels& known = benchmark.levels[kEntryFactor];
  if (known.contains(name))
    throw InputError(file.string() + ": the benchmark has an entry " + name +
                     " already; expected a file of another name");
  for (const IniEntry& entry : entries)
    find_experiment_key(entry.section, entry.key, entry_place(file, entry));
  known[name] = std::move(entries);
  benchmark.entries.push_back(name);
  return name;
}

CampaignFile benchmark_campaign(const Benchmark& benchmark, const BenchmarkChoice& choice) {
  const auto suite = benchmark.suites.find(choice.suite);
  if (suite == benchmark.suites.end()) {
    std::vector<std::string> names;
    for (const auto& [name, unused] : benchmark.suites) names.push_back(name);
    throw InputError(benchmark.path.string() + ": no suite '" + choice.suite + "'; known are " +
                     name_list(names));
  }
  std::vector<IniEntry> entries;
  const auto add = [&entries](const char* section, const std::string& key,
                              const std::string& value) {
    entries.push_back({section, key, value, 0});
  };
  const std::vector<std::uint64_t>& test_seeds =
      suite->second.test_seeds.empty() ? benchmark.test_seeds : suite->second.test_seeds;
  const std::vector<std::uint64_t>& seeds = choice.training ? benchmark.training_seeds : test_seeds;
  const std::size_t wanted = choice.seeds.value_or(suite->second.seeds);
  if (wanted == 0 || wanted > seeds.size())
    throw InputError("--seeds " + std::to_string(wanted) + ": allowed are 1 to " +
                     std::to_string(seeds.size()));
  std::vector<std::string> numbers;
  for (std::size_t i = 0; i < wanted; ++i) numbers.push_back(std::to_string(seeds[i]));
  add("campaign", "name", "leveling-" + choice.suite + (choice.training ? "-training" : ""));
  add("campaign", "experiment", benchmark.experiment);
  add("campaign", "seeds", name_list(numbers));
  add("campaign", "keep", keep_name(choice.keep));
  bool has_duration = false;
  for (const std::string& factor : factor_names()) {
    std::vector<std::string> levels;
    if (const auto listed = suite->second.levels.find(factor); listed != suite->second.levels.end())
      levels = listed->second;
    if (factor == kEntryFactor) {
      if (!choice.entries.empty()) levels = choice.entries;
      if (levels.empty()) levels = benchmark.entries;
    }
    if (levels.empty() && factor == kWorldFactor) continue;
    if (levels.empty())
      throw InputError(benchmark.path.string() + ": [suite " + choice.suite + "] has no " + factor);
    add("grid", factor, name_list(levels));
    for (const std::string& level : levels) {
      const auto& known = benchmark.levels.at(factor);
      const auto found = known.find(level);
      if (found == known.end()) {
        std::vector<std::string> all;
        for (const auto& [name, unused] : known) all.push_back(name);
        refuse_level(factor, level, all);
      }
      for (const IniEntry& entry : found->second) {
        const bool duration = entry.section == "experiment" && entry.key == "duration";
        has_duration = has_duration || duration;
        const std::string place = std::string(factor).append(" ").append(level);
        entries.push_back({place, entry.section + "." + entry.key,
                           duration && suite->second.duration_s.has_value()
                               ? shortest(*suite->second.duration_s)
                               : entry.value,
                           entry.line});
      }
    }
  }
  if (suite->second.duration_s.has_value() && !has_duration)
    add("set", "experiment.duration", shortest(*suite->second.duration_s));
  return make_campaign_file(benchmark.path, entries);
}

}  // namespace screed
