// A Gaussian low-pass over samples on a grid.
#pragma once

#include <cstdint>
#include <vector>

namespace screed {

/// What a filter finds beyond the edge of its samples.
enum class FilterEdge : uint8_t {
  kWrapped,    ///< the samples again: those of repeating terrain
  kReflected,  ///< their mirror image (c b a | a b c), so that their sum stays as it is
  kRepeated,   ///< the sample at the edge, again and again
};

/// Filters width x height samples, row by row, along both directions. sigma: standard deviation in
/// samples, more than 0; weights end at 4 sigma and add up to 1. The same samples give the same
/// bits.
void gaussian_filter(std::vector<double>& samples, int width, int height, double sigma,
                     FilterEdge edge);

}  // namespace screed
