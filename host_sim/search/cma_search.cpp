// pagmo's CMA-ES evaluates one point after the other, from within. A generation's points follow
// from the state before it alone, not from what its first points are worth. So a copy of the state
// goes ahead and tells the points; the state itself follows when all of them are known.
#include "host_sim/search/cma_search.h"

#include <cmath>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <stdexcept>
#include <utility>

namespace screed {
namespace {

/// The points that were asked for, and what they are worth where that is known.
struct Exchange {
  std::vector<std::vector<double>> points;
  std::vector<double> values;  ///< empty: the points are only written down
  std::size_t next = 0;
};

/// What pagmo believes to optimise. All copies share the exchange.
struct UnitCube {
  pagmo::vector_double fitness(const pagmo::vector_double& point) const {
    if (exchange->values.empty()) {
      exchange->points.push_back(point);
      return {0.0};
    }
    if (exchange->next >= exchange->points.size() || exchange->points[exchange->next] != point)
      throw std::logic_error("CMA-ES asks for another point than before");
    return {exchange->values[exchange->next++]};
  }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    return {pagmo::vector_double(dimensions, 0.0), pagmo::vector_double(dimensions, 1.0)};
  }

  std::size_t dimensions = 1;
  std::shared_ptr<Exchange> exchange = std::make_shared<Exchange>();
};

constexpr std::size_t kMinPopulation = 5;  // pagmo's

}  // namespace

struct CmaSearch::State {
  State(const std::vector<double>& start, const Options& options)
      : cube{start.size()},
        // Never done by itself: what is evaluated is noisy, and has few values.
        algorithm(1, -1, -1, -1, -1, options.sigma, 0.0, 0.0, true, true, options.seed),
        population(cube, 0U, options.seed) {
    // The first of them is where the search begins: the best. The others differ in value alone.
    for (std::size_t i = 0; i < options.population; ++i)
      population.push_back(start, {static_cast<double>(i)});
  }

  UnitCube cube;
  pagmo::cmaes algorithm;
  pagmo::population population;
};

CmaSearch::CmaSearch(const std::vector<double>& start, const Options& options) {
  if (options.population < kMinPopulation || !(options.sigma > 0.0 && options.sigma <= 1.0) ||
      start.empty())
    throw std::invalid_argument("CMA-ES: population, step or start");
  for (const double component : start)
    if (!(component >= 0.0 && component <= 1.0))
      throw std::invalid_argument("CMA-ES: the start is not in the unit cube");
  state_ = std::make_unique<State>(start, options);
}

CmaSearch::CmaSearch(CmaSearch&&) noexcept = default;
CmaSearch& CmaSearch::operator=(CmaSearch&&) noexcept = default;
CmaSearch::~CmaSearch() = default;

std::vector<std::vector<double>> CmaSearch::ask() const {
  Exchange& exchange = *state_->cube.exchange;
  exchange = {};
  pagmo::cmaes(state_->algorithm).evolve(state_->population);
  exchange.points.resize(state_->population.size());
  return exchange.points;
}

void CmaSearch::tell(const std::vector<double>& values) {
  if (values.size() != state_->population.size())
    throw std::invalid_argument("CMA-ES: a value for each point");
  for (const double value : values)
    if (!std::isfinite(value)) throw std::invalid_argument("CMA-ES: a value is not finite");
  ask();
  state_->cube.exchange->values = values;
  state_->population = state_->algorithm.evolve(state_->population);
}

}  // namespace screed
