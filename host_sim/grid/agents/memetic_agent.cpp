// Algorithms 3 and 4, the agent's part.
#include "host_sim/grid/agents/memetic_agent.h"

namespace screed {

MemeticAgent::MemeticAgent(const MemeticParameters& parameters, uint32_t seed, uint32_t stream)
    : random_(seed, stream), memory_(parameters.memory_length), parameters_(parameters) {
  for (uint8_t i = 0; i < kMaxChromosomes; ++i) chromosomes_[i] = random_chromosome(random_);
}

GridAction MemeticAgent::tick(const GridInput& input) {
  if (input.arrived && bernoulli(random_.next() & 0xFFFFU, parameters_.sense)) {
    memory_.add(input.height);
  }
  const uint8_t gene = chromosomes_[current_].genes[gene_];
  GridAction action = {GridOperation::kNone, kGridStay};
  if (gene < kGridDirections) {
    action.direction = gene;
  } else {
    if (parameters_.fitness_base == FitnessBase::kAttempted) ++fitness_[current_].operations;
    action.operation = gene == kGenePickUp ? pick_up(input.height) : deposit(input.height);
  }
  advance();
  return action;
}

GridOperation MemeticAgent::pick_up(uint16_t height) {
  if (carries_ || !memory_.is_above(height)) return GridOperation::kNone;
  carries_ = true;
  taken_from_ = static_cast<uint16_t>(height - 1);
  Fitness& fitness = fitness_[current_];
  if (parameters_.fitness_base == FitnessBase::kExecuted) ++fitness.operations;
  ++fitness.positive;
  return GridOperation::kPickUp;
}

GridOperation MemeticAgent::deposit(uint16_t height) {
  if (!carries_ || !memory_.is_below(height)) return GridOperation::kNone;
  carries_ = false;
  const uint16_t left = static_cast<uint16_t>(height + 1);
  const uint16_t difference = left > taken_from_ ? static_cast<uint16_t>(left - taken_from_)
                                                 : static_cast<uint16_t>(taken_from_ - left);
  Fitness& fitness = fitness_[current_];
  if (parameters_.fitness_base == FitnessBase::kExecuted) ++fitness.operations;
  if (difference > 1) ++fitness.positive;
  return GridOperation::kDeposit;
}

void MemeticAgent::advance() {
  if (++gene_ < kGenes) return;
  gene_ = 0;
  if (++repetition_ < parameters_.repetitions) return;
  repetition_ = 0;
  if (++current_ < parameters_.chromosomes) return;
  current_ = 0;
  if (parameters_.selects_itself) select();
}

void MemeticAgent::select() {
  for (uint8_t i = 0; i < parameters_.chromosomes; ++i) {
    if (fitness_[i].below(parameters_.threshold)) chromosomes_[i] = random_chromosome(random_);
    fitness_[i] = Fitness();
  }
}

void MemeticAgent::renew() {
  chromosomes_[0] = random_chromosome(random_);
  keep();
}

}  // namespace screed
