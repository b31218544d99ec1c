// What a search for better parameters of a leveling algorithm is to do: an INI file, read as
// strictly as experiments are. docs/benchmark.md explains it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/benchmark/benchmark_file.h"
#include "host_sim/benchmark/benchmark_score.h"
#include "host_sim/core/ini_file.h"

namespace screed {

/// A parameter of the robot that is searched for: integers from low to high.
struct SearchedParameter {
  std::string name;
  std::int16_t low = 0;
  std::int16_t high = 0;
  std::int16_t start = 0;
};

enum class EvolutionObjective : std::uint8_t {
  kLevel,     ///< height about level at the end by that at the start, less 1
  kProgress,  ///< of transport
};

struct EvolutionFile {
  std::filesystem::path path;
  std::string suite = "single";  ///< of the benchmark; one course
  std::string entry;             ///< whose parameters are searched
  EvolutionObjective objective = EvolutionObjective::kLevel;
  std::size_t population = 8;  ///< candidates of a generation, at least 5
  std::size_t generations = 10;
  double sigma = 0.25;  ///< first step, of each parameter's range
  std::uint32_t seed = 1;
  std::vector<std::uint64_t> beds;  ///< training beds of the search
  std::size_t beds_a_generation = 2;
  double duration_s = 1800.0;  ///< of a run of the search
  std::size_t finalists = 3;
  std::vector<std::uint64_t> verification_beds;  ///< training beds, none of `beds`
  std::vector<SearchedParameter> parameters;
  std::vector<IniEntry> coarse;  ///< keys that the search's runs have otherwise, as in [set]
};

/// Throws InputError.
EvolutionFile read_evolution_file(const std::filesystem::path& path);
/// The same from a text; messages call it `name`.
EvolutionFile read_evolution_text(const std::string& text, const std::filesystem::path& name);

// The search: generations of candidates by CMA-ES, each evaluated on beds of its own, then the
// middle and the best of the last one on beds that the search never saw, at the fine setting and at
// the search's, beside what there was before.
//
// A generation has the same beds for all of its candidates, and other ones than the last. What runs
// the beds is handed in: the campaign engine, or a test. Nothing else here takes time, so a search
// that was cut off is done again from its start, and the engine, which keeps what it has run, is at
// once where it was.

/// Parameters that were tried, and what they reached.
struct Candidate {
  std::string name;                  ///< g3c1: the first of the third generation; middle
  std::vector<std::int16_t> values;  ///< of EvolutionFile::parameters
  EntryScore score;
};

/// What one campaign is to run: these entries, on these beds.
struct EvolutionTask {
  std::string name;     ///< of its folder: generation-03, verification, verification-coarse
  std::string against;  ///< the entry that the others are compared with; "" none
  std::vector<std::string> entries;
  std::vector<std::uint64_t> beds;
  bool coarse = true;
};
/// Runs it, on a benchmark that has the candidates as entries. The scores are in the order of the
/// entries.
using EvolutionRunner =
    std::function<std::vector<EntryScore>(const Benchmark& benchmark, const EvolutionTask& task)>;

struct Evolution {
  std::vector<Candidate> archive;  ///< in the order in which they were tried
  /// The entry as it was, then finalists, the middle of the last generation first: at the fine
  /// setting and, on the same beds, at the search's.
  std::vector<Candidate> fine;
  std::vector<EntryScore> coarse;
  /// The best of `fine`; nothing when that is the entry as it was.
  std::optional<std::size_t> best;
};

/// Of a candidate: the lower the better. One whose runs failed counts as one that doubled
/// the height about level.
double value_of(const EntryScore& score, EvolutionObjective objective);

/// `told` hears of each generation. Throws InputError when the benchmark has no such suite, entry
/// or bed, or one of the beds is none of its training beds; what `run` throws.
Evolution evolve(const EvolutionFile& file, const Benchmark& benchmark, const EvolutionRunner& run,
                 const std::function<void(std::size_t generation, const Evolution&)>& told = {});

/// The campaign of a task.
CampaignFile evolution_campaign(const EvolutionFile& file, Benchmark benchmark,
                                const EvolutionTask& task);

/// A row a candidate: name, parameters, figures.
std::string archive_csv(const EvolutionFile& file, const Evolution& evolution);
/// An experiment file with the entry's algorithm and these parameters: an entry of the benchmark.
std::string entry_text(const EvolutionFile& file, const Benchmark& benchmark,
                       const Candidate& candidate);

}  // namespace screed
