// Generations, and what is verified at their end.
#include "host_sim/benchmark/evolution.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "host_sim/core/errors.h"
#include "host_sim/core/name_list.h"
#include "host_sim/run/experiment/experiment_keys.h"
#include "host_sim/search/cma_search.h"

namespace screed {
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
  constexpr double kFailed = 1.0;  // relief doubled, ground carried the wrong way
  const double value =
      objective == EvolutionObjective::kRelief ? score.relief_change.mean : -score.progress.mean;
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
  text += ",runs,failed,ended_early,relief_change,progress,energy_j\n";
  for (const Candidate& candidate : evolution.archive) {
    text += candidate.name;
    for (const std::int16_t value : candidate.values) text += "," + std::to_string(value);
    const EntryScore& score = candidate.score;
    text += "," + std::to_string(score.runs) + "," + std::to_string(score.failed) + "," +
            std::to_string(score.ended_early);
    for (const double value : {score.relief_change.mean, score.progress.mean, score.energy_j.mean})
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
