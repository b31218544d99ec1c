// Everything that decides a run of the grid world. Same configuration, same run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/grid/grid_agents.h"
#include "host_sim/grid/grid_world.h"

namespace screed {

enum class GridAlgorithm {
  kProbabilistic,  ///< Algorithm 1, constant probabilities
  kThreshold,      ///< Algorithm 1, response thresholds
  kMemetic1,       ///< Algorithm 3
  kMemetic2,       ///< Algorithm 4
  kPatient,        ///< ours: dead band, running average, straight walks
  kForager,        ///< ours: and hold-out, slope, turning back
};
inline constexpr GridAlgorithm kGridAlgorithms[] = {
    GridAlgorithm::kProbabilistic, GridAlgorithm::kThreshold, GridAlgorithm::kMemetic1,
    GridAlgorithm::kMemetic2,      GridAlgorithm::kPatient,   GridAlgorithm::kForager};

/// Its name on the command line, in files and tables.
const char* name_of(GridAlgorithm algorithm);
/// Throws InputError for a name that no algorithm has.
GridAlgorithm grid_algorithm(const std::string& name);

struct GridConfig {
  GridAlgorithm algorithm = GridAlgorithm::kProbabilistic;
  uint64_t seed = 1;
  int agents = 8;
  uint64_t max_cycles = 1'000'000;  ///< a run that is not level by then has failed
  GridStopRule stop;

  // Terrain.
  NoiseParameters noise;        ///< border holds for images as well
  std::filesystem::path image;  ///< empty: noise
  int image_width = 0;          ///< cells; 0: a cell a pixel
  int image_height = 0;
  double white = 13.0;               ///< units, of a white pixel
  std::optional<double> image_mean;  ///< units; empty: as the image has it

  // Agents. Empty: what suits the algorithm (with_defaults() below).
  std::optional<double> p_sense;  ///< 0.01; ours 1
  std::optional<double> p_turn;   ///< 0.75; ours 0.05
  double p_pick_up = 0.3;         ///< probabilistic
  double p_deposit = 0.3;
  double k = 6.0;                         ///< threshold
  int memory = HeightMemory::kMaxLength;  ///< samples of the FIFO; the thesis' algorithms
  double fitness_threshold = 1.0;         ///< memetic-2: a chromosome below it is replaced
  int chromosomes = 5;                    ///< memetic-2, an agent
  int repetitions = 5;                    ///< memetic-1, of a chromosome
  FitnessBase fitness_base = FitnessBase::kExecuted;
  int averaging = 1024;               ///< ours, samples
  std::optional<double> dead_band;    ///< ours, units: patient 0.9, forager 0.8
  int patience = 100;                 ///< ours, cycles
  std::optional<int> hold_out;        ///< ours, cycles: patient 0, forager 200
  std::optional<bool> follows_slope;  ///< ours: patient no, forager yes
  std::optional<bool> turns_back;     ///< ours: patient no, forager yes
};

/// The configuration with every empty option filled in.
GridConfig with_defaults(GridConfig config);

/// Throws InputError for the first value out of range: its name, the value, what is allowed.
void check(const GridConfig& config);

/// Every value as name and text, in a fixed order: for recordings, hashes and reports.
std::vector<std::pair<std::string, std::string>> describe(const GridConfig& config);

/// What the agents are given. `config` has its defaults filled in and is checked.
ProbabilisticParameters probabilistic_parameters(const GridConfig& config);
MemeticParameters memetic_parameters(const GridConfig& config);
ForagingParameters foraging_parameters(const GridConfig& config);

/// The terrain of the configuration and its seed.
GridTerrain make_terrain(const GridConfig& config);

}  // namespace screed
