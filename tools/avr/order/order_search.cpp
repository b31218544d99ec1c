#include "tools/avr/order/order_search.h"

#include <algorithm>
#include <cmath>
#include <regex>
#include <utility>

#include "host_sim/core/random.h"

namespace screed::avr_order {

namespace {

constexpr double kFirstTemperature = 3.0;
constexpr double kLastTemperature = 0.05;
constexpr std::size_t kLongestBlock = 12;

std::size_t below(screed::WorldRandom& random, std::size_t count) {
  return static_cast<std::size_t>(random.uniform() * static_cast<double>(count));
}

/// Another order: a block of sections elsewhere, most often of one.
std::vector<std::size_t> moved(std::vector<std::size_t> order, screed::WorldRandom& random) {
  const std::size_t begin = below(random, order.size());
  const std::size_t length =
      std::min(random.uniform() < 0.7 ? 1 : 1 + below(random, kLongestBlock), order.size() - begin);
  const auto first = order.begin() + static_cast<std::ptrdiff_t>(begin);
  const std::vector<std::size_t> block(first, first + static_cast<std::ptrdiff_t>(length));
  order.erase(first, first + static_cast<std::ptrdiff_t>(length));
  const std::size_t to = below(random, order.size() + 1);
  order.insert(order.begin() + static_cast<std::ptrdiff_t>(to), block.begin(), block.end());
  return order;
}

/// Simulated annealing from the order that the image has.
FunctionOrder search(ImageCalls& image, std::uint64_t seed, int moves) {
  screed::WorldRandom random(seed, "function order");
  std::vector<std::size_t> order = image.order();
  int cost = image.long_calls(order);
  FunctionOrder best{order, cost};
  for (int move = 0; move < moves; ++move) {
    const double left = 1.0 - static_cast<double>(move) / moves;
    const double temperature = kLastTemperature + kFirstTemperature * left * left;
    std::vector<std::size_t> other = moved(order, random);
    const int other_cost = image.long_calls(other);
    if (other_cost > cost && random.uniform() >= std::exp((cost - other_cost) / temperature))
      continue;
    order = std::move(other);
    cost = other_cost;
    if (cost < best.long_calls) best = {order, cost};
  }
  return best;
}

}  // namespace

FunctionOrder best_order(ImageCalls& image, std::uint64_t searches, int moves) {
  FunctionOrder best{image.order(), image.long_calls(image.order())};
  for (std::uint64_t seed = 1; seed <= searches; ++seed) {
    FunctionOrder found = search(image, seed, moves);
    if (found.long_calls < best.long_calls) best = std::move(found);
  }
  return best;
}

std::string pattern_of(const std::string& section) {
  return std::regex_replace(section, std::regex(R"((\.(lto_priv|isra|part|constprop)\.\d+)+)"),
                            "*");
}

}  // namespace screed::avr_order
