#include "tools/avr/order/order_search.h"

#include <algorithm>
#include <cmath>
#include <regex>
#include <utility>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"

namespace screed::avr_order {

namespace {

/// A reach of rcall and rjmp, bytes.
constexpr double kReach = 4094.0;
/// The image is shorter than the model by the calls that become short.
constexpr double kShrink = 0.97;

}  // namespace

std::vector<Section> read_map(std::istream& in) {
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
  if (sections.empty()) throw InputError("no sections of .text in this map");
  std::sort(sections.begin(), sections.end(),
            [](const Section& a, const Section& b) { return a.begin < b.begin; });
  return sections;
}

ImageCalls::ImageCalls(std::vector<Section> sections, const avr_stack::Disassembly& code)
    : sections_(std::move(sections)) {
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

int ImageCalls::long_calls(const std::vector<std::size_t>& order) {
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

std::size_t ImageCalls::section_at(std::uint32_t address) const {
  const auto after =
      std::upper_bound(sections_.begin(), sections_.end(), address,
                       [](std::uint32_t a, const Section& s) { return a < s.begin; });
  if (after == sections_.begin()) return sections_.size();
  const auto i = static_cast<std::size_t>(after - sections_.begin()) - 1;
  return address < sections_[i].begin + sections_[i].size ? i : sections_.size();
}

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
