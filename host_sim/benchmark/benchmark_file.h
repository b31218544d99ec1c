// The leveling benchmark as its file tells it: beds, soils, sizes and robots, the entries that are
// scored, and suites, which say what runs together.
//
// The file is a campaign's (host_sim/campaign) with factors of named levels, and two kinds of
// sections more: [benchmark] and [suite NAME]. Reading is as strict. docs/benchmark.md explains it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_file.h"
#include "host_sim/core/ini_file.h"

namespace screed {

/// What a run is driven in, where a suite compares worlds; a suite that does not say runs in the
/// physics.
inline constexpr const char* kWorldFactor = "world";
/// The factors that make a course, in the order in which their levels are put on a run.
inline constexpr const char* kCourseFactors[] = {"size", "bed", "soil", "robots", "position"};
/// The factor of what is scored: an algorithm with its parameters.
inline constexpr const char* kEntryFactor = "entry";

/// What runs together.
struct BenchmarkSuite {
  /// Levels by the factor's name. Without entries: all of the benchmark.
  std::map<std::string, std::vector<std::string>> levels;
  std::size_t seeds = 1;  ///< the first so many of the set of beds
  /// Those of the benchmark's test beds that it runs on. Empty: all.
  std::vector<std::uint64_t> test_seeds;
  std::optional<double> duration_s;  ///< in place of that of [robots ...]
};

struct Benchmark {
  std::filesystem::path path;
  int version = 0;
  std::string experiment;  ///< file of what all runs have in common, beside the benchmark's
  std::vector<std::uint64_t> training_seeds;
  std::vector<std::uint64_t> test_seeds;
  /// What each level of a factor sets; factor, level.
  std::map<std::string, std::map<std::string, std::vector<IniEntry>>> levels;
  std::vector<std::string> entries;  ///< in the order of the file, then those added
  std::map<std::string, BenchmarkSuite> suites;
};

/// The benchmark of the program's data, or that of a file. To its entries those algorithms of the
/// robot are added that none of them uses, with their default parameters. Throws InputError.
Benchmark read_benchmark(const std::filesystem::path& path);
std::filesystem::path benchmark_path();

/// Adds an entry: an experiment file of which [experiment] algorithm and whatever else the
/// algorithm is to have count; the name is that of the file. Throws InputError when a course
/// decides one of its keys, or the benchmark has an entry of that name.
std::string add_entry(const std::filesystem::path& file, Benchmark& benchmark);

/// What of a benchmark is run.
struct BenchmarkChoice {
  std::string suite;
  bool training = false;                  ///< on the training beds, not on the test beds
  std::vector<std::string> entries = {};  ///< empty: the suite's
  std::optional<std::size_t> seeds = {};  ///< in place of the suite's
  CampaignKeep keep = CampaignKeep::kCurves;
};

/// A campaign of all courses of the suite with each entry and seed. Throws InputError.
CampaignFile benchmark_campaign(const Benchmark& benchmark, const BenchmarkChoice& choice);

}  // namespace screed
