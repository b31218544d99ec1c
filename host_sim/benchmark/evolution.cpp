// The file of a search, and the search.
#include "host_sim/benchmark/evolution.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <utility>

#include "firmware/parameters/parameters.h"
#include "host_sim/campaign/campaign_values.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/core/name_list.h"
#include "host_sim/run/experiment/experiment_keys.h"
#include "host_sim/search/cma_search.h"

namespace screed {

namespace {

namespace fs = std::filesystem;

constexpr const char* kKeys[] = {"suite",    "entry",     "objective",         "population",
                                 "seed",     "sigma",     "generations",       "beds",
                                 "duration", "finalists", "beds_a_generation", "verification_beds"};

class Reader {
 public:
  explicit Reader(fs::path path) { file_.path = std::move(path); }

  void take(const IniEntry& entry) {
    const std::string where = entry_place(file_.path, entry);
    if (entry.section == "evolution") {
      take_setting(entry, where);
    } else if (entry.section == "search") {
      take_parameter(entry, where);
    } else if (entry.section == "coarse") {
      take_coarse(entry, where);
    } else {
      throw InputError(where + ": unknown section; known are [evolution], [search] and [coarse]");
    }
  }

  EvolutionFile done() {
    const auto need = [this](bool there, const char* what) {
      if (!there) throw InputError(file_.path.string() + ": has no " + what);
    };
    need(!file_.entry.empty(), "[evolution] entry");
    need(!file_.beds.empty(), "[evolution] beds");
    need(!file_.verification_beds.empty(), "[evolution] verification_beds");
    need(!file_.parameters.empty(), "[search] with a parameter");
    for (const std::uint64_t bed : file_.verification_beds) {
      if (std::find(file_.beds.begin(), file_.beds.end(), bed) != file_.beds.end())
        throw InputError(file_.path.string() + ": bed " + std::to_string(bed) +
                         " is one of beds and of verification_beds; what was searched on verifies "
                         "nothing");
    }
    if (file_.beds_a_generation > file_.beds.size())
      throw InputError(file_.path.string() + ": beds_a_generation: there are only " +
                       std::to_string(file_.beds.size()) + " beds");
    return std::move(file_);
  }

 private:
  [[noreturn]] static void refuse(const IniEntry& entry, const std::string& where,
                                  const std::string& allowed) {
    throw InputError(where + " = '" + entry.value + "' is not allowed; expected " + allowed);
  }

  template <class Number>
  static void take_number(const IniEntry& entry, const std::string& where, double low, double high,
                          Number& number) {
    if (!parse_number(entry.value, number) || !(static_cast<double>(number) >= low) ||
        !(static_cast<double>(number) <= high)) {
      refuse(entry, where, "a number from " + shortest(low) + " to " + shortest(high));
    }
  }

  void take_setting(const IniEntry& entry, const std::string& where) {
    if (entry.key == "suite") {
      file_.suite = entry.value;
    } else if (entry.key == "entry") {
      file_.entry = entry.value;
    } else if (entry.key == "objective") {
      if (entry.value == "level") {
        file_.objective = EvolutionObjective::kLevel;
      } else if (entry.value == "progress") {
        file_.objective = EvolutionObjective::kProgress;
      } else {
        refuse(entry, where, "level or progress");
      }
    } else if (entry.key == "population") {
      take_number(entry, where, 5, 1000, file_.population);
    } else if (entry.key == "generations") {
      take_number(entry, where, 1, 10000, file_.generations);
    } else if (entry.key == "sigma") {
      take_number(entry, where, 0.001, 1, file_.sigma);
    } else if (entry.key == "seed") {
      take_number(entry, where, 0, 4294967295.0, file_.seed);
    } else if (entry.key == "beds") {
      file_.beds = parse_seeds(entry.value, where);
    } else if (entry.key == "beds_a_generation") {
      take_number(entry, where, 1, 1000, file_.beds_a_generation);
    } else if (entry.key == "duration") {
      take_number(entry, where, 0.01, 1e6, file_.duration_s);
    } else if (entry.key == "finalists") {
      take_number(entry, where, 1, 100, file_.finalists);
    } else if (entry.key == "verification_beds") {
      file_.verification_beds = parse_seeds(entry.value, where);
    } else {
      throw InputError(where + ": unknown key; known are " +
                       name_list(std::vector<std::string>(std::begin(kKeys), std::end(kKeys))));
    }
  }

  /// "100..300": within the parameter's own range; or "100..300 from 150".
  void take_parameter(const IniEntry& entry, const std::string& where) {
    const auto* const info =
        std::find_if(std::begin(kParameterTable), std::end(kParameterTable),
                     [&](const ParameterInfo& known) { return entry.key == known.name; });
    if (info == std::end(kParameterTable))
      throw InputError(where + ": is no parameter of the robot (screed sim --keys lists them)");
    SearchedParameter parameter{entry.key, 0, 0, info->default_value};
    std::string range = entry.value;
    const std::size_t from = range.find(" from ");
    const bool has_start = from != std::string::npos;
    const std::string start = has_start ? range.substr(from + 6) : "";
    if (has_start) range.resize(from);
    const std::size_t dots = range.find("..");
    const bool read = dots != std::string::npos &&
                      parse_number(range.substr(0, dots), parameter.low) &&
                      parse_number(range.substr(dots + 2), parameter.high) &&
                      (!has_start || parse_number(start, parameter.start));
    if (!read || parameter.low < info->min || parameter.high > info->max ||
        parameter.low >= parameter.high) {
      refuse(entry, where,
             "LOW..HIGH or LOW..HIGH from START, within " + std::to_string(info->min) + " to " +
                 std::to_string(info->max));
    }
    if (parameter.start < parameter.low || parameter.start > parameter.high)
      throw InputError(where + ": begins at " + std::to_string(parameter.start) +
                       ", which is not in the range; expected another range, or one with from");
    file_.parameters.push_back(parameter);
  }

  void take_coarse(const IniEntry& entry, const std::string& where) {
    const std::size_t dot = entry.key.find('.');
    if (dot == std::string::npos)
      throw InputError(where + ": expected section.key of an experiment file");
    find_experiment_key(entry.key.substr(0, dot), entry.key.substr(dot + 1), where);
    file_.coarse.push_back(entry);
  }

  EvolutionFile file_;
};

}  // namespace

EvolutionFile read_evolution_file(const fs::path& path) {
  Reader reader(path);
  for (const IniEntry& entry : read_ini_file(path)) reader.take(entry);
  return reader.done();
}

EvolutionFile read_evolution_text(const std::string& text, const fs::path& name) {
  Reader reader(name);
  for (const IniEntry& entry : read_ini_text(text, name.string())) reader.take(entry);
  return reader.done();
}

// Generations, and what is verified at their end.

namespace {

double in_range(const SearchedParameter& parameter, double value) {
  return (value - parameter.low) / (parameter.high - parameter.low);
}

std::vector<double> start_of(const EvolutionFile& file) {
  std::vector<double> start;
  for (const SearchedParameter& parameter : file.parameters)
    start.push_back(in_range(parameter, parameter.start));
  return start;
}

std::vector<std::int16_t> values_at(const EvolutionFile& file, const std::vector<double>& point) {
  std::vector<std::int16_t> values;
  for (std::size_t i = 0; i < point.size(); ++i) {
    const SearchedParameter& parameter = file.parameters[i];
    values.push_back(static_cast<std::int16_t>(
        std::lround(parameter.low + point[i] * (parameter.high - parameter.low))));
  }
  return values;
}

/// What the entry sets beside the parameters that are searched.
std::vector<IniEntry> entries_of(const EvolutionFile& file, const Benchmark& benchmark,
                                 const std::vector<std::int16_t>& values) {
  std::vector<IniEntry> entries;
  for (const IniEntry& entry : benchmark.levels.at(kEntryFactor).at(file.entry)) {
    const bool searched =
        entry.section == "parameters" &&
        std::any_of(file.parameters.begin(), file.parameters.end(),
                    [&](const SearchedParameter& known) { return known.name == entry.key; });
    if (!searched) entries.push_back(entry);
  }
  for (std::size_t i = 0; i < values.size(); ++i)
    entries.push_back({"parameters", file.parameters[i].name, std::to_string(values[i]), 0});
  return entries;
}

void add_candidate(const EvolutionFile& file, const Candidate& candidate, Benchmark& benchmark) {
  benchmark.levels[kEntryFactor][candidate.name] = entries_of(file, benchmark, candidate.values);
}

void check(const EvolutionFile& file, const Benchmark& benchmark) {
  const auto suite = benchmark.suites.find(file.suite);
  if (suite == benchmark.suites.end())
    throw InputError(file.path.string() + ": the benchmark has no suite '" + file.suite + "'");
  for (const char* factor : kCourseFactors) {
    const auto levels = suite->second.levels.find(factor);
    if (levels != suite->second.levels.end() && levels->second.size() > 1)
      throw InputError(file.path.string() + ": the suite '" + file.suite +
                       "' has several courses; expected one with one " + std::string(factor));
  }
  if (!benchmark.levels.at(kEntryFactor).contains(file.entry))
    throw InputError(file.path.string() + ": the benchmark has no entry '" + file.entry +
                     "'; known are " + name_list(benchmark.entries));
  for (const auto& beds : {file.beds, file.verification_beds}) {
    for (const std::uint64_t bed : beds) {
      if (std::find(benchmark.training_seeds.begin(), benchmark.training_seeds.end(), bed) ==
          benchmark.training_seeds.end())
        throw InputError(file.path.string() + ": " + std::to_string(bed) +
                         " is no training bed of the benchmark");
    }
  }
}

/// Beds of a generation, one after the other through all of them.
std::vector<std::uint64_t> beds_of(const EvolutionFile& file, std::size_t generation) {
  std::vector<std::uint64_t> beds;
  for (std::size_t i = 0; i < file.beds_a_generation; ++i)
    beds.push_back(file.beds[(generation * file.beds_a_generation + i) % file.beds.size()]);
  return beds;
}

std::string two_digits(std::size_t number) {
  return (number < 10 ? "0" : "") + std::to_string(number);
}

/// A candidate and the point of the search that it stands for.
struct Tried {
  std::vector<double> point;
  Candidate candidate;
};

/// Where CMA-ES goes on from these: the mean of their better half, the best of them weighing most
/// (Hansen 2016, "The CMA Evolution Strategy: A Tutorial", eq. 6 and 49). `best_first`.
std::vector<double> middle_of(const std::vector<Tried>& best_first) {
  std::vector<double> middle(best_first.front().point.size(), 0.0);
  const double count = static_cast<double>(best_first.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < best_first.size() / 2; ++i) {
    const double weight = std::log((count + 1.0) / 2.0) - std::log(static_cast<double>(i + 1));
    sum += weight;
    for (std::size_t k = 0; k < middle.size(); ++k) middle[k] += weight * best_first[i].point[k];
  }
  for (double& component : middle) component /= sum;
  return middle;
}

/// Of the last generation alone: what an earlier one reached is for other beds, and the best of all
/// would be who had the easiest of them. Its middle, which chance favours least, then its best, all
/// with different values.
std::vector<Candidate> finalists_of(const EvolutionFile& file, std::vector<Tried> last) {
  std::stable_sort(last.begin(), last.end(), [&](const Tried& a, const Tried& b) {
    return value_of(a.candidate.score, file.objective) <
           value_of(b.candidate.score, file.objective);
  });
  Candidate middle;
  middle.name = "middle";
  middle.values = values_at(file, middle_of(last));
  std::vector<Candidate> finalists = {middle};
  for (const Tried& tried : last) {
    if (finalists.size() == file.finalists) break;
    if (std::none_of(finalists.begin(), finalists.end(), [&](const Candidate& known) {
          return known.values == tried.candidate.values;
        }))
      finalists.push_back(tried.candidate);
  }
  return finalists;
}

}  // namespace

double value_of(const EntryScore& score, EvolutionObjective objective) {
  constexpr double kFailed = 1.0;  // height about level doubled, ground carried the wrong way
  const double value =
      objective == EvolutionObjective::kLevel ? score.level_change.mean : -score.progress.mean;
  if (score.failed != 0 || !std::isfinite(value)) return kFailed;
  return value;
}

CampaignFile evolution_campaign(const EvolutionFile& file, Benchmark benchmark,
                                const EvolutionTask& task) {
  BenchmarkChoice choice;
  choice.suite = file.suite;
  choice.training = true;
  choice.entries = task.entries;
  choice.seeds = task.beds.size();
  choice.keep = CampaignKeep::kSummary;
  benchmark.training_seeds = task.beds;
  if (task.coarse) benchmark.suites.at(file.suite).duration_s = file.duration_s;
  CampaignFile campaign = benchmark_campaign(benchmark, choice);
  campaign.settings.name = task.name;
  if (!task.coarse) return campaign;
  for (const IniEntry& entry : file.coarse) {
    const std::size_t dot = entry.key.find('.');
    CampaignFactor factor;
    factor.heading = entry.key;
    factor.keys = {{entry.key.substr(0, dot), entry.key.substr(dot + 1)}};
    factor.values = {entry.value};
    factor.where =
        file.path.string() + ":" + std::to_string(entry.line) + ": [coarse] " + entry.key;
    campaign.fixed.push_back(std::move(factor));
  }
  return campaign;
}

Evolution evolve(const EvolutionFile& file, const Benchmark& benchmark, const EvolutionRunner& run,
                 const std::function<void(std::size_t, const Evolution&)>& told) {
  check(file, benchmark);
  CmaSearch search(start_of(file), {file.population, file.sigma, file.seed});
  Evolution evolution;
  std::vector<Tried> last;
  for (std::size_t generation = 0; generation < file.generations; ++generation) {
    EvolutionTask task{
        "generation-" + two_digits(generation + 1), "", {}, beds_of(file, generation)};
    Benchmark with_candidates = benchmark;
    std::vector<Candidate> candidates;
    const std::vector<std::vector<double>> points = search.ask();
    for (const std::vector<double>& point : points) {
      Candidate candidate;
      candidate.name =
          "g" + std::to_string(generation + 1) + "c" + std::to_string(candidates.size() + 1);
      candidate.values = values_at(file, point);
      candidates.push_back(std::move(candidate));
    }
    // Points that round to the same parameters are one entry: a campaign has no cell twice.
    std::vector<std::size_t> entry_of;
    for (const Candidate& candidate : candidates) {
      std::size_t first = 0;
      while (candidates[first].values != candidate.values) ++first;
      if (candidates[first].name == candidate.name) {
        add_candidate(file, candidate, with_candidates);
        task.entries.push_back(candidate.name);
        entry_of.push_back(task.entries.size() - 1);
      } else {
        entry_of.push_back(entry_of[first]);
      }
    }
    const std::vector<EntryScore> scores = run(with_candidates, task);
    std::vector<double> values;
    last.clear();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      candidates[i].score = scores.at(entry_of[i]);
      values.push_back(value_of(candidates[i].score, file.objective));
      evolution.archive.push_back(candidates[i]);
      last.push_back({points[i], candidates[i]});
    }
    search.tell(values);
    if (told) told(generation, evolution);
  }

  EvolutionTask task{"verification", file.entry, {file.entry}, file.verification_beds, false};
  Benchmark with_finalists = benchmark;
  Candidate before;
  before.name = file.entry;
  evolution.fine.push_back(before);
  for (Candidate& finalist : finalists_of(file, std::move(last))) {
    add_candidate(file, finalist, with_finalists);
    task.entries.push_back(finalist.name);
    evolution.fine.push_back(std::move(finalist));
  }
  const std::vector<EntryScore> fine = run(with_finalists, task);
  task.name = "verification-coarse";
  task.coarse = true;
  evolution.coarse = run(with_finalists, task);
  std::size_t best = 0;
  for (std::size_t i = 0; i < evolution.fine.size(); ++i) {
    evolution.fine[i].score = fine.at(i);
    if (value_of(fine[i], file.objective) < value_of(fine[best], file.objective)) best = i;
  }
  if (best != 0) evolution.best = best;
  return evolution;
}

std::string archive_csv(const EvolutionFile& file, const Evolution& evolution) {
  std::string text = "candidate";
  for (const SearchedParameter& parameter : file.parameters) text += "," + parameter.name;
  text += ",runs,failed,ended_early,level_change,progress,energy_j\n";
  for (const Candidate& candidate : evolution.archive) {
    text += candidate.name;
    for (const std::int16_t value : candidate.values) text += "," + std::to_string(value);
    const EntryScore& score = candidate.score;
    text += "," + std::to_string(score.runs) + "," + std::to_string(score.failed) + "," +
            std::to_string(score.ended_early);
    for (const double value : {score.level_change.mean, score.progress.mean, score.energy_j.mean})
      text += "," + (std::isfinite(value) ? shortest(value) : std::string());
    text += "\n";
  }
  return text;
}

std::string entry_text(const EvolutionFile& file, const Benchmark& benchmark,
                       const Candidate& candidate) {
  std::string text = "; Found by screed level evolve " + file.path.filename().string() + ": " +
                     candidate.name + ".\n";
  std::string section;
  for (const IniEntry& entry : entries_of(file, benchmark, candidate.values)) {
    if (entry.section != section) text += "\n[" + entry.section + "]\n";
    section = entry.section;
    text += entry.key + " = " + entry.value + "\n";
  }
  return text;
}

}  // namespace screed
