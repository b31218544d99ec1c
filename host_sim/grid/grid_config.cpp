// Configurations of the grid world: names, defaults, what is allowed, and their fixed-point form.
#include "host_sim/grid/grid_config.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr const char* kNames[] = {"probabilistic", "threshold", "memetic-1",
                                  "memetic-2",     "patient",   "forager"};
static_assert(std::size(kNames) == std::size(kGridAlgorithms));

std::string text(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.9g", value);
  return buffer;
}

[[noreturn]] void refuse(const std::string& name, const std::string& value,
                         const std::string& allowed) {
  throw InputError("grid: " + name + " = " + value + "; allowed is " + allowed);
}

void check_range(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high)) refuse(name, text(value), text(low) + " to " + text(high));
}

void check_probability(const char* name, double value) {
  if (!(value >= 0.0 && value <= 1.0)) refuse(name, text(value), "a probability, 0 to 1");
}

void check_positive(const char* name, double value, double high) {
  if (!(value > 0.0 && value <= high)) {
    refuse(name, text(value), "more than 0, at most " + text(high));
  }
}

void check_cells(int width, int height) {
  if (width < 1 || height < 1 || width > kLargestGridSide || height > kLargestGridSide) {
    refuse("size", std::to_string(width) + "x" + std::to_string(height),
           "1x1 to " + std::to_string(kLargestGridSide) + "x" + std::to_string(kLargestGridSide));
  }
}

Probability q16(double probability) {
  return static_cast<Probability>(std::lround(probability * kAlways));
}

bool is_ours(GridAlgorithm algorithm) {
  return algorithm == GridAlgorithm::kPatient || algorithm == GridAlgorithm::kForager;
}

}  // namespace

const char* name_of(GridAlgorithm algorithm) {
  return kNames[static_cast<size_t>(algorithm)];
}

GridAlgorithm grid_algorithm(const std::string& name) {
  std::string all;
  for (const GridAlgorithm algorithm : kGridAlgorithms) {
    if (name == name_of(algorithm)) return algorithm;
    all += (all.empty() ? "" : ", ") + std::string(name_of(algorithm));
  }
  refuse("algorithm", name, all);
}

GridConfig with_defaults(GridConfig config) {
  const bool ours = is_ours(config.algorithm);
  if (!config.p_sense) config.p_sense = ours ? 1.0 : 0.01;
  if (!config.p_turn) config.p_turn = ours ? 0.05 : 0.75;
  const bool patient = config.algorithm == GridAlgorithm::kPatient;
  if (!config.dead_band) config.dead_band = patient ? 0.9 : 0.8;
  if (!config.hold_out) config.hold_out = patient ? 0 : 200;
  if (!config.follows_slope) config.follows_slope = !patient;
  if (!config.turns_back) config.turns_back = !patient;
  return config;
}

void check(const GridConfig& raw) {
  const GridConfig config = with_defaults(raw);
  check_probability("p-sense", *config.p_sense);
  check_probability("p-turn", *config.p_turn);
  check_probability("p-pick-up", config.p_pick_up);
  check_probability("p-deposit", config.p_deposit);
  check_probability("fitness-threshold", config.fitness_threshold);
  check_positive("k", config.k, 255.0);
  if (config.k < 1.0 / 256.0) refuse("k", text(config.k), "at least 1/256");
  check_range("memory", config.memory, 1, HeightMemory::kMaxLength);
  check_range("chromosomes", config.chromosomes, 1, MemeticAgent::kMaxChromosomes);
  check_range("repetitions", config.repetitions, 1, 100);
  check_range("averaging", config.averaging, 1, 32767);
  check_range("dead-band", *config.dead_band, 0, 255);
  check_range("patience", config.patience, 0, 65535);
  check_range("hold-out", *config.hold_out, 0, 65535);
  check_range("epsilon", config.stop.epsilon, 0, kMaxStackHeight);
  if (config.max_cycles == 0) refuse("max-cycles", "0", "at least 1");

  if (config.image.empty()) {
    check_cells(config.noise.width, config.noise.height);
    check_positive("lattice", config.noise.lattice, 1e6);
    check_range("amplitude", config.noise.amplitude, 0, 10000);
    check_range("mean", config.noise.mean, 0, 10000);
  } else {
    if (config.image_width != 0 || config.image_height != 0) {
      check_cells(config.image_width, config.image_height);
    }
    check_positive("white", config.white, 10000);
    if (config.image_mean) check_range("mean", *config.image_mean, 0, 10000);
  }
  if (config.agents < 1) refuse("agents", std::to_string(config.agents), "at least 1");
  const bool size_known = config.image.empty() || config.image_width != 0;
  const int64_t cells = config.image.empty() ? int64_t{config.noise.width} * config.noise.height
                                             : int64_t{config.image_width} * config.image_height;
  if (size_known && config.agents > cells) {
    refuse("agents", std::to_string(config.agents), "at most one a cell, " + std::to_string(cells));
  }
}

std::vector<std::pair<std::string, std::string>> describe(const GridConfig& raw) {
  const GridConfig config = with_defaults(raw);
  const bool noise = config.image.empty();
  const char* measure[] = {"level", "gradient", "deviation"};
  std::vector<std::pair<std::string, std::string>> values = {
      {"algorithm", name_of(config.algorithm)},
      {"seed", std::to_string(config.seed)},
      {"agents", std::to_string(config.agents)},
      {"max-cycles", std::to_string(config.max_cycles)},
      {"stop", measure[static_cast<size_t>(config.stop.measure)]},
      {"epsilon", text(config.stop.epsilon)},
      {"border", config.noise.border == GridBorder::kWalls ? "walls" : "torus"},
      {"terrain", noise ? "noise" : config.image.string()},
      {"size",
       noise ? std::to_string(config.noise.width) + "x" + std::to_string(config.noise.height)
             : std::to_string(config.image_width) + "x" + std::to_string(config.image_height)},
      {"mean", noise               ? text(config.noise.mean)
               : config.image_mean ? text(*config.image_mean)
                                   : "as the image"},
      {"amplitude", text(config.noise.amplitude)},
      {"lattice", text(config.noise.lattice)},
      {"white", text(config.white)},
      {"p-sense", text(*config.p_sense)},
      {"p-turn", text(*config.p_turn)},
      {"p-pick-up", text(config.p_pick_up)},
      {"p-deposit", text(config.p_deposit)},
      {"k", text(config.k)},
      {"memory", std::to_string(config.memory)},
      {"fitness-threshold", text(config.fitness_threshold)},
      {"chromosomes", std::to_string(config.chromosomes)},
      {"repetitions", std::to_string(config.repetitions)},
      {"fitness-base", config.fitness_base == FitnessBase::kExecuted ? "executed" : "attempted"},
      {"averaging", std::to_string(config.averaging)},
      {"dead-band", text(*config.dead_band)},
      {"patience", std::to_string(config.patience)},
      {"hold-out", std::to_string(*config.hold_out)},
      {"follow-slope", *config.follows_slope ? "yes" : "no"},
      {"turn-back", *config.turns_back ? "yes" : "no"}};
  return values;
}

ProbabilisticParameters probabilistic_parameters(const GridConfig& config) {
  const bool threshold = config.algorithm == GridAlgorithm::kThreshold;
  return {q16(*config.p_sense),
          q16(config.p_pick_up),
          q16(config.p_deposit),
          q16(*config.p_turn),
          threshold ? static_cast<uint16_t>(std::lround(config.k * 256.0)) : uint16_t{0},
          static_cast<uint8_t>(config.memory)};
}

MemeticParameters memetic_parameters(const GridConfig& config) {
  const bool second = config.algorithm == GridAlgorithm::kMemetic2;
  return {q16(*config.p_sense),
          static_cast<uint8_t>(config.memory),
          static_cast<uint8_t>(second ? config.chromosomes : 1),
          static_cast<uint8_t>(second ? 1 : config.repetitions),
          second,
          q16(config.fitness_threshold),
          config.fitness_base};
}

ForagingParameters foraging_parameters(const GridConfig& config) {
  return {q16(*config.p_sense),
          static_cast<uint16_t>(config.averaging),
          static_cast<uint16_t>(std::lround(*config.dead_band * 256.0)),
          static_cast<uint16_t>(config.patience),
          static_cast<uint16_t>(*config.hold_out),
          q16(*config.p_turn),
          *config.follows_slope,
          *config.turns_back};
}

GridTerrain make_terrain(const GridConfig& config) {
  WorldRandom random(config.seed, "grid terrain");
  if (config.image.empty()) return noise_terrain(config.noise, random);
  GridTerrain terrain =
      image_terrain(config.image, config.image_width, config.image_height, config.white);
  if (config.image_mean) {
    const auto cells = static_cast<double>(terrain.heights.size());
    adjust_sum(terrain, static_cast<uint64_t>(std::llround(*config.image_mean * cells)), random);
  }
  return terrain;
}

}  // namespace screed
