// CMA-ES (Hansen, "The CMA Evolution Strategy: A Comparing Review", 2006) by pagmo2, as questions
// and answers: whoever asks may evaluate all points of a generation at once, and in any order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace screed {

class CmaSearch {
 public:
  struct Options {
    std::size_t population = 8;  ///< points of a generation, at least 5
    double sigma = 0.25;         ///< first step, of the side of the unit cube; 0..1
    std::uint32_t seed = 1;
  };

  /// Searches the unit cube from `start`, whose components are 0..1. The same start, options and
  /// answers give the same points. Throws std::invalid_argument for a start or options that are not
  /// allowed.
  CmaSearch(const std::vector<double>& start, const Options& options);
  CmaSearch(CmaSearch&&) noexcept;
  CmaSearch& operator=(CmaSearch&&) noexcept;
  ~CmaSearch();

  /// The points of the next generation, `population` of them, components 0..1.
  std::vector<std::vector<double>> ask() const;

  /// What they are worth, in the order of ask(): the lower the better, each finite. The next ask()
  /// gives another generation. Throws std::invalid_argument for another number of values.
  void tell(const std::vector<double>& values);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace screed
