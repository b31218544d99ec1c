// avr_order: in which order the functions of an image lie, so that as many calls as possible reach
// their functions with a rcall, which is 2 bytes shorter than a call and reaches 4 kB.
//
// Reads the linker's map and the disassembly of an image, and prints the sections of its functions,
// one a line, for the linker script of hal/avr/firmware.mk. The order is found by simulated
// annealing on a model of the image: sections of their sizes, all calls long.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <map>
#include <numeric>
#include <regex>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "tools/avr/stack/disassembly.h"
#include "tools/screed/cli/program.h"

namespace {

using screed::InputError;
using screed::avr_stack::Disassembly;

struct Options {
  std::string map;
  std::string disassembly;
  std::uint64_t searches = 6;
  int moves = 9'000'000;
};

/// A reach of rcall and rjmp, bytes.
constexpr double kReach = 4094.0;
/// The image is shorter than the model by the calls that become short.
constexpr double kShrink = 0.97;
constexpr double kFirstTemperature = 3.0;
constexpr double kLastTemperature = 0.05;
constexpr std::size_t kLongestBlock = 12;

struct Section {
  std::uint32_t begin;
  std::uint32_t size;
  std::string name;
  bool movable;
};

/// A call or jump from one section to another.
struct Call {
  std::size_t from, to;
  double from_offset, to_offset;
};

std::ifstream opened(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw InputError("cannot read " + path);
  return in;
}

/// Input sections of the image's .text, by address.
std::vector<Section> read_map(const std::string& path) {
  std::ifstream in = opened(path);
  // A long name stands on a line of its own, before address and size.
  const std::regex name_alone(R"(^ (\.[\w.$]+)\s*$)");
  const std::regex section(R"(^ (\.[\w.$]+)?\s+0x([0-9a-f]+)\s+0x([0-9a-f]+)\s+\S+)");
  std::vector<Section> sections;
  std::string line;
  std::string pending;
  std::smatch match;
  bool inside = false;
  while (std::getline(in, line)) {
    if (line.rfind(".text ", 0) == 0) {
      inside = true;
    } else if (inside && !line.empty() && line[0] == '.') {
      break;
    } else if (inside && std::regex_match(line, match, name_alone)) {
      pending = match[1];
    } else if (inside && std::regex_search(line, match, section)) {
      const std::string name = match[1].matched ? match[1].str() : pending;
      pending.clear();
      const auto size = static_cast<std::uint32_t>(std::stoul(match[3], nullptr, 16));
      if (name.empty() || size == 0) continue;
      const bool movable = name.rfind(".text", 0) == 0;
      sections.push_back(
          {static_cast<std::uint32_t>(std::stoul(match[2], nullptr, 16)), size, name, movable});
    }
  }
  if (sections.empty()) throw InputError(path + ": no sections of .text in this map");
  std::sort(sections.begin(), sections.end(),
            [](const Section& a, const Section& b) { return a.begin < b.begin; });
  return sections;
}

class Model {
 public:
  Model(std::vector<Section> sections, const Disassembly& code) : sections_(std::move(sections)) {
    for (const auto& [address, it] : code.instructions()) {
      const bool is_short = it.mnemonic == "rcall" || it.mnemonic == "rjmp";
      if (!it.target || (!is_short && it.mnemonic != "call" && it.mnemonic != "jmp")) continue;
      const auto from = section_at(address);
      const auto to = section_at(*it.target);
      if (from == to || from == sections_.size() || to == sections_.size()) continue;
      calls_.push_back({from, to, static_cast<double>(address - sections_[from].begin),
                        static_cast<double>(*it.target - sections_[to].begin)});
      if (is_short) sections_[from].size += 2;
    }
    places_.resize(sections_.size());
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      places_[i] = sections_[i].begin;
      if (sections_[i].movable) order_.push_back(i);
    }
    if (order_.empty()) throw InputError("the map has no functions");
    begin_ = sections_[order_.front()].begin;
  }

  /// Calls that stay long in this order of movable sections.
  int cost(const std::vector<std::size_t>& order) {
    double at = begin_;
    for (const std::size_t i : order) {
      places_[i] = at;
      at += sections_[i].size;
    }
    int far = 0;
    for (const Call& call : calls_) {
      const double distance =
          places_[call.to] + call.to_offset - places_[call.from] - call.from_offset;
      far += std::abs(distance) * kShrink > kReach ? 1 : 0;
    }
    return far;
  }

  const std::vector<std::size_t>& order() const { return order_; }
  const std::string& name(std::size_t section) const { return sections_[section].name; }
  std::size_t calls() const { return calls_.size(); }

 private:
  std::size_t section_at(std::uint32_t address) const {
    const auto after =
        std::upper_bound(sections_.begin(), sections_.end(), address,
                         [](std::uint32_t a, const Section& s) { return a < s.begin; });
    if (after == sections_.begin()) return sections_.size();
    const auto i = static_cast<std::size_t>(after - sections_.begin()) - 1;
    return address < sections_[i].begin + sections_[i].size ? i : sections_.size();
  }

  std::vector<Section> sections_;
  std::vector<Call> calls_;
  std::vector<double> places_;
  std::vector<std::size_t> order_;
  double begin_ = 0.0;
};

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

struct Order {
  std::vector<std::size_t> sections;
  int long_calls;
};

/// Simulated annealing from the order that the image has.
Order search(Model& model, std::uint64_t seed, int moves) {
  screed::WorldRandom random(seed, "function order");
  std::vector<std::size_t> order = model.order();
  int cost = model.cost(order);
  Order best{order, cost};
  for (int move = 0; move < moves; ++move) {
    const double left = 1.0 - static_cast<double>(move) / moves;
    const double temperature = kLastTemperature + kFirstTemperature * left * left;
    std::vector<std::size_t> other = moved(order, random);
    const int other_cost = model.cost(other);
    if (other_cost > cost && random.uniform() >= std::exp((cost - other_cost) / temperature))
      continue;
    order = std::move(other);
    cost = other_cost;
    if (cost < best.long_calls) best = {order, cost};
  }
  return best;
}

/// Of several searches: they end up to a fifth apart.
Order best_order(Model& model, const Options& options) {
  Order best{model.order(), model.cost(model.order())};
  std::fprintf(stderr, "%zu calls between functions, %d of them long", model.calls(),
               best.long_calls);
  for (std::uint64_t seed = 1; seed <= options.searches; ++seed) {
    Order found = search(model, seed, options.moves);
    if (found.long_calls < best.long_calls) best = std::move(found);
  }
  std::fprintf(stderr, "; in the new order %d\n", best.long_calls);
  return best;
}

/// The section's name without what the compiler numbers anew with every change.
std::string pattern_of(const std::string& name) {
  return std::regex_replace(name, std::regex(R"((\.(lto_priv|isra|part|constprop)\.\d+)+)"), "*");
}

int run(const Options& options) {
  std::ifstream in = opened(options.disassembly);
  Model model(read_map(options.map), Disassembly::read(in));
  for (const std::size_t section : best_order(model, options).sections)
    std::printf("%s\n", pattern_of(model.name(section)).c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Order of an image's functions with few long calls", "avr_order");
  app.add_option("map", options.map, "Map of the linker")->required();
  app.add_option("disassembly", options.disassembly, "Output of avr-objdump -d")->required();
  app.add_option("--searches", options.searches, "Searches, of which the best counts")
      ->check(CLI::Range(1, 1000));
  app.add_option("--moves", options.moves, "Orders tried in each")
      ->check(CLI::Range(1, 100'000'000));
  return screed::run_program(app, argc, argv, [&] { return run(options); });
}
