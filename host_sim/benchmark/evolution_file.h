// What a search for better parameters of a leveling algorithm is to do: an INI file, read as
// strictly as experiments are. docs/benchmark.md explains it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

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
  kRelief,    ///< relief at the end by that at the start, less 1
  kProgress,  ///< of transport
};

struct EvolutionFile {
  std::filesystem::path path;
  std::string suite = "single";  ///< of the benchmark; one course
  std::string entry;             ///< whose parameters are searched
  EvolutionObjective objective = EvolutionObjective::kRelief;
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

}  // namespace screed
