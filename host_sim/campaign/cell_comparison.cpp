#include "host_sim/campaign/cell_comparison.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace screed {
namespace {

SeedMean seed_mean(const std::vector<double>& values) {
  return {values.size(), mean_of(values), bootstrap_mean_interval(values)};
}

std::vector<double> defined(const MetricValues& values, std::size_t cell) {
  std::vector<double> result;
  for (std::size_t seed = 0; seed < values.seeds(); ++seed) {
    if (!std::isnan(values.at(cell, seed))) result.push_back(values.at(cell, seed));
  }
  return result;
}

PairedDifference difference(const MetricValues& values, std::size_t cell, std::size_t baseline) {
  std::vector<double> differences;
  for (std::size_t seed = 0; seed < values.seeds(); ++seed) {
    const double by = values.at(cell, seed) - values.at(baseline, seed);
    if (!std::isnan(by)) differences.push_back(by);
  }
  return {seed_mean(differences), signed_rank(differences)};
}

/// One row a seed that has all values.
std::vector<std::vector<double>> complete_rows(const MetricValues& values) {
  std::vector<std::vector<double>> rows;
  for (std::size_t seed = 0; seed < values.seeds(); ++seed) {
    std::vector<double> row(values.cells());
    for (std::size_t cell = 0; cell < row.size(); ++cell) row[cell] = values.at(cell, seed);
    if (std::none_of(row.begin(), row.end(), [](double value) { return std::isnan(value); }))
      rows.push_back(std::move(row));
  }
  return rows;
}

void adjust_for_number(std::vector<CellComparison>& cells) {
  std::vector<double> p;
  for (const CellComparison& cell : cells) {
    if (cell.against_baseline) p.push_back(cell.against_baseline->test.p);
  }
  const std::vector<double> adjusted = holm(p);
  auto next = adjusted.begin();
  for (CellComparison& cell : cells) {
    if (cell.against_baseline) cell.against_baseline->p_holm = *next++;
  }
}

}  // namespace

MetricValues::MetricValues(std::vector<double> values, std::size_t seeds)
    : values_(std::move(values)), seeds_(seeds) {
  if (seeds_ == 0 || values_.size() % seeds_ != 0)
    throw std::logic_error("a metric has a value a run");
}

std::vector<CellComparison> compare_cells(const MetricValues& values, std::size_t baseline) {
  std::vector<CellComparison> result(values.cells());
  for (std::size_t cell = 0; cell < result.size(); ++cell) {
    result[cell].value = seed_mean(defined(values, cell));
    if (cell != baseline) result[cell].against_baseline = difference(values, cell, baseline);
  }
  adjust_for_number(result);
  const std::vector<MeanRank> ranks = mean_ranks(complete_rows(values));
  for (std::size_t cell = 0; cell < ranks.size(); ++cell) result[cell].rank = ranks[cell];
  return result;
}

SeedMean mean_over_cells(const MetricValues& values, const std::vector<std::size_t>& cells) {
  std::vector<double> means;
  for (std::size_t seed = 0; seed < values.seeds(); ++seed) {
    std::vector<double> of_seed;
    for (const std::size_t cell : cells) {
      if (!std::isnan(values.at(cell, seed))) of_seed.push_back(values.at(cell, seed));
    }
    if (!of_seed.empty()) means.push_back(mean_of(of_seed));
  }
  return seed_mean(means);
}

std::vector<FactorLevel> levels_of(const std::vector<std::vector<std::string>>& cells,
                                   std::size_t factor) {
  std::vector<FactorLevel> levels;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    const std::string& value = cells[cell][factor];
    auto level = std::find_if(levels.begin(), levels.end(),
                              [&value](const FactorLevel& it) { return it.value == value; });
    if (level == levels.end()) level = levels.insert(level, {value, {}});
    level->cells.push_back(cell);
  }
  return levels;
}

}  // namespace screed
